; P-ERR-21642 tap_feed_mode.nc line 3 column 1 'G63 Z-10 F2 S200': G63 needs a feed in mm/min (G94), G93 is active
G93
G63 Z-10 F2 S200
M30
