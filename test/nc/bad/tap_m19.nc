; P-ERR-21640 tap_m19.nc line 3 column 1 'M19 S.POS=0': M19 with G63: the path turns the spindle; end G63 with another path function first
G63 Z-10 F250 S200
M19 S.POS=0
M30
