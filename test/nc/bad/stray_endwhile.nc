; P-ERR-20237 stray_endwhile.nc line 2 column 1 '$ENDWHILE': $ENDWHILE without $WHILE before it
$ENDWHILE
M30
