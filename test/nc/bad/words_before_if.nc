; P-ERR-21571 words_before_if.nc line 2 column 1 'X5 $IF 1': $IF must be alone in its block, 'X5' stands before it
X5 $IF 1
$ENDIF
M30
