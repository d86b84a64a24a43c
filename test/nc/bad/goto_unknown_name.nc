; P-ERR-21575 goto_unknown_name.nc line 3 column 8 '$GOTO [END]': main program has no label [END]; did you mean [ENDE]?
[ENDE] X1
$GOTO [END]
M30
