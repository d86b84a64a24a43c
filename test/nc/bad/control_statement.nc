; P-ERR-21566 control_statement.nc line 2 column 5 'N10 $IFF P1 == 1': $IFF is no control statement; did you mean $IF?
N10 $IFF P1 == 1
M30
