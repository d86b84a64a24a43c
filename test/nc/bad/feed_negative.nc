; P-ERR-21022 feed_negative.nc line 2 column 13 'N10 G01 X10 F-600': feed F-600 is negative
N10 G01 X10 F-600
M30
