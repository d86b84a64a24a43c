; P-ERR-21012 dwell_and_motion.nc line 2 column 9 'N10 G01 G04 X10': G01 and G04 belong to one group (path) and cannot be in one block
N10 G01 G04 X10
M30
