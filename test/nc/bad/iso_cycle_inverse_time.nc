; P-ERR-21815 iso_cycle_inverse_time.nc line 4 column 1 'G81 X1 Z-5 R5 F100': G81 with G93: a drilling cycle needs a feed per minute (G94)
; dialect iso
G93
G81 X1 Z-5 R5 F100
M30
