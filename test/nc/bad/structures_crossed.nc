; P-ERR-21567 structures_crossed.nc line 4 column 1 '$ENDIF': $ENDIF stands within $WHILE of line 3, which has no $ENDWHILE yet
$IF 1
$WHILE 0
$ENDIF
$ENDWHILE
M30
