; P-ERR-21013 iso_d_without_meaning.nc line 3 column 1 'D1': D has no meaning with G00
; dialect iso
D1
M30
