; P-ERR-21010 h_too_large.nc line 2 column 1 'H65536': H65536 must be an integer from 0 to 65535
H65536
M30
