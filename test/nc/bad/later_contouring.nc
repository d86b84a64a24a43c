; P-ERR-21050 later_contouring.nc line 2 column 1 'G261': G261 is not available yet: contouring of corners
G261
M30
