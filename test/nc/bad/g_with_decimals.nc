; P-ERR-20131 g_with_decimals.nc line 2 column 5 'N10 G1.5 X10 F600': unknown G function G1.5
N10 G1.5 X10 F600
M30
