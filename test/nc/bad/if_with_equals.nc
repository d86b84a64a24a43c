; P-ERR-21409 if_with_equals.nc line 2 column 7 '$IF P1=5': '=' assigns; two values are compared by '=='
$IF P1=5
$ENDIF
M30
