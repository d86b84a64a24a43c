; P-ERR-21409 while_with_equals.nc line 2 column 10 '$WHILE P1=5': '=' assigns; two values are compared by '=='
$WHILE P1=5
$ENDWHILE
M30
