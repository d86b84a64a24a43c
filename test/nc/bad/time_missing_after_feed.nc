; P-ERR-20008 time_missing_after_feed.nc line 3 column 1 'G93 X5': G01 without a feed: no F greater than 0 was programmed
G01 X1 F100
G93 X5
M30
