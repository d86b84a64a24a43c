; P-ERR-21655 tap_two.nc line 3 column 20 'G63 Z-10 F250 S200 S2=100': G63 with the speeds of two spindles, S and S2: the path turns one of them
; machine X Y Z / three
G63 Z-10 F250 S200 S2=100
M30
