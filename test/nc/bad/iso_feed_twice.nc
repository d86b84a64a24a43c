; P-ERR-21008 iso_feed_twice.nc line 3 column 10 'G1 X1 F1 F2': word F twice in one block: 1 and 2
; dialect iso
G1 X1 F1 F2
M30
