; The same part in a grid of zero offsets that the program makes.
%L PART
G00 X0 Y0 Z1
G01 Z-1 F300
G02 I5 F800
G00 Z1
M29
%GRID
P1 = 1
$FOR P2 = 0, 1, 1
$FOR P3 = 0, 2, 1
V.G.NP[P1].V.X = P3 * 30
V.G.NP[P1].V.Y = P2 * 25
P1 = P1 + 1
$ENDFOR
$ENDFOR
$FOR P1 = 1, 6, 1
G159=P1
LL PART
$ENDFOR
G53
M30
