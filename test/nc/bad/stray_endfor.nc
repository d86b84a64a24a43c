; P-ERR-20232 stray_endfor.nc line 2 column 1 '$ENDFOR': $ENDFOR without $FOR before it
$ENDFOR
M30
