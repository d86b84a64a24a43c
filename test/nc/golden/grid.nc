; A grid of engraved squares, each in its own coordinate system, every second row shifted.
%L SQUARE
G00 X0 Y0
G01 Z-0.5 F200
X8 F800
Y8
X0
Y0
G00 Z1
M29
%GRID
G90 G00 Z1
$FOR P1 = 0, 1, 1
$FOR P2 = 0, 2, 1
#CS ON [P2 * 10 + [P1 MOD 2] * 5, P1 * 10, 0, 0, 0, P2 * 5]
LL SQUARE
#CS OFF
$ENDFOR
$ENDFOR
M30
