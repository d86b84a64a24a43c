; P-ERR-21570 switch_call_before_case.nc line 6 column 1 'LL UP': 'LL' between $SWITCH and its first $CASE is never executed
%L UP
M29
%MAIN
$SWITCH 1
LL UP
$CASE 1
$ENDSWITCH
M30
