; A pocket in layers, and a circle of holes around it.
%L LAYER
G91 G01 Z-1 F300
X[V.P.WIDTH] F1200
Y[V.P.DEPTH]
X[-V.P.WIDTH]
Y[-V.P.DEPTH]
G90
M29

%POCKET
#VAR
V.P.WIDTH = 40
V.P.DEPTH = 20
V.P.HOLES : UNS32 = 6
#ENDVAR
G90 G17 G71
M03 S1200
G92 X30 Y20                                ; corner of the pocket
G00 X0 Y0 Z2
G01 Z0 F300
$FOR P1 = 1, 3, 1
LL LAYER
$ENDFOR
G00 Z5

#CS ON [20, 10]                            ; its centre
L CYCLE [NAME=drill.nc @P1=-6 @P2=5 MODAL_MOVE]
$FOR P1 = 0, V.P.HOLES - 1, 1
P2 = P1 * 360 / V.P.HOLES
G00 X[30 * COS[P2]] Y[18 * SIN[P2]]
$ENDFOR
#DISABLE MODAL CYCLE
#CS OFF
G00 Z20
X0 Y0
M30
