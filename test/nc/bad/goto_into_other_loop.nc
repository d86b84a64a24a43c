; P-ERR-21576 goto_into_other_loop.nc line 3 column 8 '$GOTO [IN]': $GOTO [IN] leads into $WHILE of line 6
$WHILE 0
$GOTO [IN]
$ENDWHILE
$FOR P1=1,2,1
$WHILE 0
[IN] X5
$ENDWHILE
$ENDFOR
M30
