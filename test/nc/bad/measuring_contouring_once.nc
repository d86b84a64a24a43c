; P-ERR-120652 measuring_contouring_once.nc line 2 column 9 'N10 G61 G100 X9 F300': G100 while contouring (G61) is on; G260 ends it
N10 G61 G100 X9 F300
M30
