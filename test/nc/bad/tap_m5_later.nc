; P-ERR-21640 tap_m5_later.nc line 3 column 1 'M5': M05 with G63: the path turns the spindle; end G63 with another path function first
G63 Z-10 F250 S200
M5
M30
