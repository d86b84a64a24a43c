; P-ERR-21570 switch_before_case.nc line 3 column 1 'X5': 'X5' between $SWITCH and its first $CASE is never executed
$SWITCH 1
X5
$CASE 1
$ENDSWITCH
M30
