; P-ERR-20008 feed_missing_arc.nc line 2 column 5 'N10 G02 X10 R5': G02 without a feed: no F greater than 0 was programmed
N10 G02 X10 R5
M30
