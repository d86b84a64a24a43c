; P-ERR-21654 tap_turning.nc line 3 column 1 'G63 Z-10 F250': G63 while spindle S turns: it must be at a standstill (M05 or M19 in a block before)
M3 S200
G63 Z-10 F250
M30
