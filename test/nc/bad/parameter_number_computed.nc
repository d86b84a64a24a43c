; P-ERR-21425 parameter_number_computed.nc line 3 column 3 'P[P1]=5': P-3 does not exist: parameters are P0 to P9999
P1=-3
P[P1]=5
M30
