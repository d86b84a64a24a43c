; P-ERR-21023 dwell_missing.nc line 2 column 5 'N10 G04': G04 without a time
N10 G04
M30
