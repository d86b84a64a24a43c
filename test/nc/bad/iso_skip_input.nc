; P-ERR-21013 iso_skip_input.nc line 3 column 10 'G31 Z-5. P2 F100.': P has no meaning with G31
; dialect iso
G31 Z-5. P2 F100.
M30
