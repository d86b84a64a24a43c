; Loops by labels alone, as old controls had them.
P1 = 3
N100: G91 G00 X10
P2 = 2
N200: Y5
P2 = P2 - 1
$IF P2 > 0 $GOTO N200
P1 = P1 - 1
$IF P1 > 0 $GOTO N100
G90 X0 Y0
M30
