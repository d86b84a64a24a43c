; P-ERR-21034 iso_arc_radius_too_small.nc line 3 column 8 'G2 X10 R2 F100': radius R 2 mm is too small: start and target are 10 mm apart, at most 4 mm can be reached
; dialect iso
G2 X10 R2 F100
M30
