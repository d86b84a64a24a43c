; P-ERR-21050 iso_tapping_left.nc line 3 column 1 'G74 X1 Z-5 R1 F100': G74 is not available yet: tapping
; dialect iso
G74 X1 Z-5 R1 F100
M30
