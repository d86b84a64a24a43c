; P-ERR-21574 for_step_zero.nc line 2 column 13 '$FOR P1=1,2,0': the step of $FOR is 0: the loop would never end
$FOR P1=1,2,0
$ENDFOR
M30
