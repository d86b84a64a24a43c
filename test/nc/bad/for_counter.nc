; P-ERR-20227 for_counter.nc line 2 column 6 '$FOR 5=1,2,1': $FOR needs a parameter or a variable to count with, not '5'
$FOR 5=1,2,1
$ENDFOR
M30
