; P-ERR-21645 tap_pitch_missing.nc line 2 column 1 'G331 Z-10 S200': G331 without a pitch (I, J or K in mm per turn)
G331 Z-10 S200
M30
