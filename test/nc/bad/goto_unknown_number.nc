; P-ERR-21575 goto_unknown_number.nc line 3 column 8 '$GOTO N10': main program has no label N10
N10 X1
$GOTO N10
M30
