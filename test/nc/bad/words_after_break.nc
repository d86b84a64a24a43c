; P-ERR-20242 words_after_break.nc line 3 column 8 '$BREAK X5': 'X5' after $BREAK: it must be alone in its block
$DO
$BREAK X5
$ENDDO 0
M30
