; P-ERR-20008 feed_missing_modal.nc line 3 column 1 'N20 Y20': G01 without a feed: no F greater than 0 was programmed
N10 G01
N20 Y20
M30
