; P-ERR-21576 goto_into_loop.nc line 2 column 8 '$GOTO N5': $GOTO N5 leads into $WHILE of line 3
$GOTO N5
$WHILE 0
N5: X1
$ENDWHILE
M30
