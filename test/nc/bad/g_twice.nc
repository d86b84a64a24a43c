; P-ERR-21042 g_twice.nc line 2 column 13 'N10 G01 X10 G1 F600': G01 twice in one block
N10 G01 X10 G1 F600
M30
