; P-ERR-21806 iso_offset_fraction.nc line 3 column 7 'G54.1 P1.5 X0': P1.5 must be an integer from 1 to 90
; dialect iso
G54.1 P1.5 X0
M30
