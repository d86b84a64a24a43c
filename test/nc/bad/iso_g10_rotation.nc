; P-ERR-21013 iso_g10_rotation.nc line 3 column 14 'G10 L2 P1 X5 R45': R has no meaning with G10
; dialect iso
G10 L2 P1 X5 R45
M30
