; P-ERR-21647 tap_pitch_zero.nc line 2 column 11 'G331 Z-10 K0 S200': pitch K0 of G331 must not be 0
G331 Z-10 K0 S200
M30
