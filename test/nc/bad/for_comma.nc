; P-ERR-20229 for_comma.nc line 2 column 12 '$FOR P1=1,2': $FOR needs start, end and step with commas between them
$FOR P1=1,2
$ENDFOR
M30
