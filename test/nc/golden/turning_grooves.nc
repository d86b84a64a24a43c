; machine X Z / S
; Grooves at places of an array, each with a dwell at its bottom.
#VAR
V.P.PLACE[4] = [-10, -18, -26.5, -40]
V.P.DEPTH = 2.5
#ENDVAR
G18
M03 S800
G00 X22 Z5
$FOR P1 = 0, 3, 1
G00 Z=V.P.PLACE[P1]
G01 X[20 - V.P.DEPTH] F60
G04 0.3
G00 X22
$ENDFOR
G00 X50 Z50 M05
M30
