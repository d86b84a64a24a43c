; The place where cos(x) = x / 60 with angles in degrees, by Newton's method.
P1 = 40
P3 = 0
$DO
P2 = P1 - [COS[P1] - P1 / 60] / [-SIN[P1] * PI / 180 - 1 / 60]
P4 = ABS[P2 - P1]
P1 = P2
P3 = P3 + 1
$ENDDO P4 > 0.0000001 && P3 < 20
G00 X[ROUND[P1 * 10000] / 10000] Y[P3 < 10]
M30
