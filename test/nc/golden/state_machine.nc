; A program that goes through states by $SWITCH and $GOTO.
V.P.STATE = "begin"
P1 = 0
[NEXT]
P1 = P1 + 1
$IF P1 > 10 $GOTO [END]
$SWITCH V.P.STATE
$CASE "begin"
G00 X[P1]
V.P.STATE = "left"
$BREAK
$CASE "left"
Y[-P1]
V.P.STATE = "right"
$BREAK
$CASE "right"
Y[P1]
$IF P1 < 5
V.P.STATE = "left"
$ELSE
V.P.STATE = "end"
$ENDIF
$BREAK
$DEFAULT
Z[P1]
$GOTO [END]
$ENDSWITCH
$GOTO [NEXT]
[END] X0 Y0
M30
