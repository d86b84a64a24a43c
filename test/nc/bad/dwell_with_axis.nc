; P-ERR-20685 dwell_with_axis.nc line 2 column 12 'N10 G04 X2 Y3': G04 stands alone in its block, here with Y
N10 G04 X2 Y3
M30
