; P-ERR-21643 tap_feed_zero.nc line 2 column 10 'G63 Z-10 F0 S200': G63 with feed 0: it needs F = S times the pitch
G63 Z-10 F0 S200
M30
