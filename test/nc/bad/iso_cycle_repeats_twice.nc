; P-ERR-21819 iso_cycle_repeats_twice.nc line 3 column 23 'G81 X1 Z-5 R1 F100 L2 K2': repeats by K and by L in one block
; dialect iso
G81 X1 Z-5 R1 F100 L2 K2
M30
