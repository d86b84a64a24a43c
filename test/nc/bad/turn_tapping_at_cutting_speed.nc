; P-ERR-20636 turn_tapping_at_cutting_speed.nc line 4 column 1 'G63 Z-10 F300 S200': G63 with constant cutting speed (G96); G97 ends it
; facing X
G18 G96 S100
G63 Z-10 F300 S200
M30
