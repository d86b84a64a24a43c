; P-ERR-21006 control_statement.nc line 2 column 5 'N10 $IF V.L.A == 1': command '$IF' is not available
N10 $IF V.L.A == 1
M30
