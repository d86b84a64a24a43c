; P-ERR-20008 iso_feed_missing.nc line 3 column 1 'G1 X5': G01 without a feed: no F greater than 0 was programmed
; dialect iso
G1 X5
M30
