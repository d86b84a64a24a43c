; P-ERR-21640 tap_and_m3.nc line 2 column 20 'G63 Z-10 F250 S200 M3': M03 with G63: the path turns the spindle; end G63 with another path function first
G63 Z-10 F250 S200 M3
M30
