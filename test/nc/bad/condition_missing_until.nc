; P-ERR-21573 condition_missing_until.nc line 3 column 7 '$UNTIL': $UNTIL without a condition or a value
$REPEAT
$UNTIL
M30
