; A grid drilled by a modal call within loops, with a pause of it.
G90 G00 Z5
G01 F250
L CYCLE [NAME=g81.nc @P1=-5 @P2=2 MODAL_MOVE]
$FOR P1 = 0, 1, 1
$FOR P2 = 0, 2, 1
G00 X[P2 * 10] Y[P1 * 8]
$ENDFOR
$ENDFOR
#DISABLE MODAL CYCLE
G00 X50 Y50
L CYCLE [NAME=g85.nc @P1=-5 @P2=2 MODAL_MOVE]
X60
G80
X0
M30
