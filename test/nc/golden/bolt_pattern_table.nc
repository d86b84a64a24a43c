; Holes from a table of two columns; a value of 0 in the third leaves a hole out.
#VAR
V.P.HOLE[5][3] = [10, 10, 1, \
                  30, 10, 1, \
                  30, 40, 0, \
                  10, 40, 1, \
                  20, 25, 1]
#ENDVAR
G00 Z5
G01 F200
$FOR P1 = 0, 4, 1
$IF V.P.HOLE[P1][2] == 0
$CONTINUE
$ENDIF
G00 X=V.P.HOLE[P1][0] Y=V.P.HOLE[P1][1]
G81[-8, 1]
$ENDFOR
M30
