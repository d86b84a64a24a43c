; P-ERR-20839 goto_target.nc line 2 column 7 '$GOTO X5': 'X5' after $GOTO is neither a label N100 nor [NAME]
$GOTO X5
M30
