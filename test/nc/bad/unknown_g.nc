; P-ERR-20131 unknown_g.nc line 2 column 5 'N10 G05 X10': unknown G function G05
N10 G05 X10
M30
