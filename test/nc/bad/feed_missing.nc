; P-ERR-20008 feed_missing.nc line 3 column 5 'N20 G01 Y20': G01 without a feed: no F greater than 0 was programmed
N10 G00 X10
N20 G01 Y20
M30
