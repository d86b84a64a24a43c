; P-ERR-21013 iso_orientation_alone.nc line 3 column 6 'S100 R90': R has no meaning with G00
; dialect iso
S100 R90
M30
