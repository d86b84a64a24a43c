; P-ERR-21560 stray_else.nc line 2 column 1 '$ELSE': $ELSE without $IF before it
$ELSE
M30
