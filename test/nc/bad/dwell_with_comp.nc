; P-ERR-20685 dwell_with_comp.nc line 2 column 11 'N10 G04 5 X[COMP ON FRICT]': G04 must be alone in its block, not with X
N10 G04 5 X[COMP ON FRICT]
M30
