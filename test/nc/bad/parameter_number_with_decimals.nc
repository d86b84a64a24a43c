; P-ERR-21423 parameter_number_with_decimals.nc line 2 column 3 'P[1.5]=5': the number of a parameter needs an integer, not 1.5
P[1.5]=5
M30
