; P-ERR-21806 iso_offset_number.nc line 3 column 7 'G54.1 P91 X0': P91 must be an integer from 1 to 90
; dialect iso
G54.1 P91 X0
M30
