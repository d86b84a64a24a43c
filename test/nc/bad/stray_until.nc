; P-ERR-21564 stray_until.nc line 2 column 1 '$UNTIL 1': $UNTIL without $REPEAT before it
$UNTIL 1
M30
