; P-ERR-21643 tap_feed_missing.nc line 2 column 1 'G63 Z-10 S200': G63 with feed 0: it needs F = S times the pitch
G63 Z-10 S200
M30
