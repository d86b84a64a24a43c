; P-ERR-21030 computed_dwell_negative.nc line 3 column 1 'G04 X[P1]': dwell time of -1 s is negative
P1=-1
G04 X[P1]
M30
