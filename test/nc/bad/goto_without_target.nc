; P-ERR-21590 goto_without_target.nc line 2 column 6 '$GOTO': $GOTO without a label
$GOTO
M30
