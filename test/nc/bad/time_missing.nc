; P-ERR-20008 time_missing.nc line 2 column 5 'G93 G01 X5': G01 without a feed: no F greater than 0 was programmed
G93 G01 X5
M30
