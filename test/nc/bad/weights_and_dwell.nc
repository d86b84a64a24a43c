; P-ERR-21092 weights_and_dwell.nc line 2 column 14 'N10 G136 X80 G04': G136 takes the axis words of its block as weights, G04 cannot be in the same block
N10 G136 X80 G04
M30
