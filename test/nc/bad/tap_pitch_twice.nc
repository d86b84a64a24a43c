; P-ERR-21646 tap_pitch_twice.nc line 2 column 14 'G331 Z-10 I1 K1.25 S200': pitches I and K in one block
G331 Z-10 I1 K1.25 S200
M30
