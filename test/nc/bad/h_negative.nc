; P-ERR-21010 h_negative.nc line 2 column 1 'H-1': H-1 must be an integer from 0 to 65535
H-1
M30
