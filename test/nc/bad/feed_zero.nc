; P-ERR-20008 feed_zero.nc line 2 column 9 'G01 X10 F0': G01 without a feed: no F greater than 0 was programmed
G01 X10 F0
M30
