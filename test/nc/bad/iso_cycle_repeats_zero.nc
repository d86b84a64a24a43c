; P-ERR-21806 iso_cycle_repeats_zero.nc line 3 column 20 'G81 X1 Z-5 R1 F100 L0': L0 must be an integer from 1 to 9999
; dialect iso
G81 X1 Z-5 R1 F100 L0
M30
