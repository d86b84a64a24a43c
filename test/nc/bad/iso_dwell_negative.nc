; P-ERR-21821 iso_dwell_negative.nc line 3 column 15 'G82 X1 Z-5 R5 P-1 F100': G82: P-1 is negative
; dialect iso
G82 X1 Z-5 R5 P-1 F100
M30
