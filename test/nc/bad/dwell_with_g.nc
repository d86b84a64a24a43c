; P-ERR-20685 dwell_with_g.nc line 2 column 5 'N10 G90 G04 X2': G04 must be alone in its block, not with G90
N10 G90 G04 X2
M30
