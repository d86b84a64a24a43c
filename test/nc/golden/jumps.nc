; Labels with numbers and names, forward and backward, out of structures, in a subroutine with the same labels.
%L UP
G91
N10: Y1
P9 = P9 + 1
$IF P9 < 2 $GOTO N10
G90
$RETURN
Y1000
M29
%JUMPS
P9 = 0
$GOTO [START]
G00 X1000
[START] G00 X1
N10: X[V.A.ABS.X + 1]
$IF V.A.ABS.X < 4 $GOTO N10
LL UP
Z1 $GOTO N30
Z1000
N30: Z2
N40 [HERE] Z3
P9 = P9 + 1
$IF P9 == 3 $GOTO [HERE]
M30
