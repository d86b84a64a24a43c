; P-ERR-120652 measuring_contouring.nc line 4 column 5 'N30 G100 X9': G100 while contouring (G261) is on; G260 ends it
N10 G261
N20 G01 X5 F300
N30 G100 X9
M30
