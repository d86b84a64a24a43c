; P-ERR-21807 iso_dwell_missing.nc line 3 column 1 'G82 X1 Z-5 R5 F100': G82 without P: the dwell at the bottom in s
; dialect iso
G82 X1 Z-5 R5 F100
M30
