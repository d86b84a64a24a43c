; P-ERR-21568 elseif_after_else.nc line 4 column 1 '$ELSEIF 2': $ELSEIF after $ELSE of line 3
$IF 1
$ELSE
$ELSEIF 2
$ENDIF
M30
