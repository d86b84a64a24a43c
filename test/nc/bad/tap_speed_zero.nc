; P-ERR-21644 tap_speed_zero.nc line 2 column 15 'G63 Z-10 F250 S0': G63 with speed 0 of spindle S: it needs S = F / pitch
G63 Z-10 F250 S0
M30
