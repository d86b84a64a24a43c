; $IF with all branches, within each other, on one line with $GOTO.
P1 = 0
$FOR P1 = 1, 5, 1
$IF P1 == 1
G00 X1
$ELSEIF P1 == 2
X2
$IF P1 > 1
Y2
$ENDIF
$ELSEIF P1 == 3 || P1 == 4
X[P1] Y-1
$ELSE
X99
$ENDIF
$ENDFOR
$IF 0.4
X1000
$ENDIF
$IF 0.5
X50
$ENDIF
$IF P1 > 5 $GOTO N100
X1001
N100: X100
/ $IF 0
X101
/ $ENDIF
M30
