; P-ERR-21644 tap_speed_missing.nc line 2 column 1 'G63 Z-10 F250': G63 with speed 0 of spindle S: it needs S = F / pitch
G63 Z-10 F250
M30
