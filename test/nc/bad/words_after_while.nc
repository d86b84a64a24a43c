; P-ERR-20235 words_after_while.nc line 2 column 10 '$WHILE 0 X5': 'X5' after the condition of $WHILE
$WHILE 0 X5
$ENDWHILE
M30
