; P-ERR-21022 iso_feed_negative.nc line 3 column 7 'G1 X5 F-1': feed F-1 is negative
; dialect iso
G1 X5 F-1
M30
