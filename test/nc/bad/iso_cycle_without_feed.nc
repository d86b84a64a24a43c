; P-ERR-20008 iso_cycle_without_feed.nc line 3 column 1 'G81 X1 Z-5 R5': G81 without a feed: no F greater than 0 was programmed
; dialect iso
G81 X1 Z-5 R5
M30
