; A polygon with any number of corners by a subroutine with parameters and its default.
%L POLYGON
V.L.N = 6
$IF EXIST[@N]
V.L.N = @N
$ENDIF
G00 X[@R] Y0
G01 F1000
$FOR P9 = 1, V.L.N, 1
X[@R * COS[360 * P9 / V.L.N]] Y[@R * SIN[360 * P9 / V.L.N]]
$ENDFOR
M29
%CORNERS
LL CYCLE [NAME=POLYGON @R=10]
LL CYCLE [NAME=POLYGON @R=20 @N=4]
LL CYCLE [NAME=POLYGON @R=5 @N=3]
M30
