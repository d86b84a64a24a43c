; P-ERR-21572 words_after_if.nc line 2 column 7 '$IF 1 X5': 'X5' after $IF: it must be alone in its block
$IF 1 X5
$ENDIF
M30
