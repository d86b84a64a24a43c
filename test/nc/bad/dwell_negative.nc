; P-ERR-21030 dwell_negative.nc line 2 column 5 'N10 G04 X-1': dwell time of -1 s is negative
N10 G04 X-1
M30
