; A spiral of lines whose step keeps the deviation below a limit.
#VAR
V.L.PITCH = 4
V.L.R
#ENDVAR
G00 X0 Y0
G01 F2000
P1 = 0
$REPEAT
P1 = P1 + 30
V.L.R = V.L.PITCH * P1 / 360
X[V.L.R * COS[P1]] Y[V.L.R * SIN[P1]]
$UNTIL P1 >= 720
M30
