; P-ERR-20228 for_equals.nc line 2 column 9 '$FOR P1 1,2,1': $FOR without '=' behind its counter
$FOR P1 1,2,1
$ENDFOR
M30
