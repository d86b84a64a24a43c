; P-ERR-21006 hash_command.nc line 2 column 5 'N10 #TRAFO [1]': command '#TRAFO' is not available
N10 #TRAFO [1]
M30
