; P-ERR-20685 dwell_with_m.nc line 2 column 12 'N10 G04 X2 M08': G04 must be alone in its block, not with M08
N10 G04 X2 M08
M30
