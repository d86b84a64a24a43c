; The largest value of an array, and its place.
#VAR
P50[6] = [3, 9, 4, 12, 7, 12]
V.L.BEST = -1
V.L.AT
#ENDVAR
$FOR P1 = 0, 5, 1
$IF P50[P1] > V.L.BEST
V.L.BEST = P50[P1]
V.L.AT = P1
$ENDIF
$ENDFOR
G00 X=V.L.BEST Y=V.L.AT
M30
