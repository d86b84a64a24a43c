; P-ERR-21010 h_with_decimals.nc line 2 column 1 'H1.5': H1.5 must be an integer from 0 to 65535
H1.5
M30
