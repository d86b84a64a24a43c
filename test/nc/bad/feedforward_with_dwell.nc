; P-ERR-20685 feedforward_with_dwell.nc line 2 column 11 'N10 G04 5 G135': G04 must be alone in its block, not with G135
N10 G04 5 G135
M30
