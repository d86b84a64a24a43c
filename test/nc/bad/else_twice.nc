; P-ERR-21568 else_twice.nc line 4 column 1 '$ELSE': $ELSE after $ELSE of line 3
$IF 1
$ELSE
$ELSE
$ENDIF
M30
