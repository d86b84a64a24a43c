; P-ERR-21431 array_as_counter.nc line 5 column 6 '$FOR P10 = 1, 3, 1': P10 is an array and needs 1 index
#VAR
P10[5]
#ENDVAR
$FOR P10 = 1, 3, 1
$ENDFOR
M30
