; P-ERR-21572 words_after_endif.nc line 3 column 8 '$ENDIF X5': 'X5' after $ENDIF: it must be alone in its block
$IF 1
$ENDIF X5
M30
