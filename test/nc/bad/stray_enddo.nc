; P-ERR-21563 stray_enddo.nc line 2 column 1 '$ENDDO 1': $ENDDO without $DO before it
$ENDDO 1
M30
