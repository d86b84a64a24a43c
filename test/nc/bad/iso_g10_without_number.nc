; P-ERR-21807 iso_g10_without_number.nc line 3 column 1 'G10 L2 X5': G10 without P: the number of the zero offset; P0 is the active one
; dialect iso
G10 L2 X5
M30
