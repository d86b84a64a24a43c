; A wave with a decreasing height.
G00 X0 Y0
G01 F1500
$FOR P1 = 0, 24, 2
X[P1] Y[10 * EXP[-P1 / 20] * SIN[P1 * 30]]
$ENDFOR
M30
