; P-ERR-20008 iso_feed_missing_inverse.nc line 4 column 1 'X10': G01 without a feed: no F greater than 0 was programmed
; dialect iso
G93 G1 X5 F10
X10
M30
