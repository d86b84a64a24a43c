; P-ERR-21022 time_negative.nc line 2 column 12 'G93 G01 X5 F-1': feed F-1 is negative
G93 G01 X5 F-1
M30
