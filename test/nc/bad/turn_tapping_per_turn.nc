; P-ERR-20635 turn_tapping_per_turn.nc line 4 column 1 'G63 Z-10 S200': G63 with a feed per turn (G95); G94 ends it
M19 S.POS=0 S100
G95 F1.5
G63 Z-10 S200
M30
