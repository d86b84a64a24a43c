; P-ERR-20685 dwell_with_spindle.nc line 2 column 12 'N10 G04 X2 S2[M5]': G04 must be alone in its block, not with S2
N10 G04 X2 S2[M5]
M30
