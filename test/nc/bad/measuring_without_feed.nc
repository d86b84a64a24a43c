; P-ERR-20008 measuring_without_feed.nc line 2 column 5 'N10 G100 X9': G100 without a feed: no F greater than 0 was programmed
N10 G100 X9
M30
