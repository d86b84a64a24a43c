; P-ERR-21425 parameter_number.nc line 2 column 1 'P10000=1': P10000 does not exist: parameters are P0 to P9999
P10000=1
M30
