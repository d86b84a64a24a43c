; P-ERR-21050 iso_cutting_speed.nc line 3 column 1 'G96 S100': G96 is not available yet: constant cutting speed
; dialect iso
G96 S100
M30
