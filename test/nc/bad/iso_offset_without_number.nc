; P-ERR-21807 iso_offset_without_number.nc line 3 column 1 'G54.1 X0': G54.1 without P: the number of the zero offset
; dialect iso
G54.1 X0
M30
