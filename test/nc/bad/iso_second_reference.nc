; P-ERR-21050 iso_second_reference.nc line 3 column 1 'G30 Z0': G30 is not available yet: a second reference point
; dialect iso
G30 Z0
M30
