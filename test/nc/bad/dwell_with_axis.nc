; P-ERR-20685 dwell_with_axis.nc line 2 column 12 'N10 G04 X2 Y3': G04 must be alone in its block, not with Y
N10 G04 X2 Y3
M30
