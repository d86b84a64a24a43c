; P-ERR-21050 iso_tapping.nc line 3 column 1 'G84 X1 Z-5 R1 F100': G84 is not available yet: tapping
; dialect iso
G84 X1 Z-5 R1 F100
M30
