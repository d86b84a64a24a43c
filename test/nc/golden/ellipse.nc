; An ellipse of short lines with a step that depends on its curvature.
#VAR
V.L.A = 30
V.L.B = 12
V.L.STEP
#ENDVAR
G00 X[V.L.A] Y0
G01 F1500
P1 = 0
$WHILE P1 < 90
V.L.STEP = 15 - 10 * ABS[COS[P1]]
P1 = MIN[P1 + V.L.STEP, 90]
X[V.L.A * COS[P1]] Y[V.L.B * SIN[P1]]
$ENDWHILE
M30
