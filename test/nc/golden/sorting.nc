; An array sorted by exchanges, then visited in its order.
#VAR
P50[5] = [30, 10, 50, 20, 40]
#ENDVAR
$FOR P1 = 0, 3, 1
$FOR P2 = 0, 3 - P1, 1
$IF P50[P2] > P50[P2 + 1]
P3 = P50[P2]
P50[P2] = P50[P2 + 1]
P50[P2 + 1] = P3
$ENDIF
$ENDFOR
$ENDFOR
$FOR P1 = 0, 4, 1
G00 X=P50[P1]
$ENDFOR
M30
