; P-ERR-21092 weights_and_motion.nc line 2 column 14 'N10 G136 X80 G01 F600': G136 takes the axis words of its block as weights, G01 cannot be in the same block
N10 G136 X80 G01 F600
M30
