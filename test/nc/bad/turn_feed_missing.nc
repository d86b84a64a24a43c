; P-ERR-20008 turn_feed_missing.nc line 4 column 1 'G01 X10': G01 without a feed: no F greater than 0 was programmed
G94 F100 M03 S100
G95
G01 X10
M30
