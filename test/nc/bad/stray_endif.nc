; P-ERR-20218 stray_endif.nc line 2 column 1 '$ENDIF': $ENDIF without $IF before it
$ENDIF
M30
