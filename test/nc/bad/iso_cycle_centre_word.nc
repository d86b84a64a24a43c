; P-ERR-21013 iso_cycle_centre_word.nc line 3 column 15 'G81 X1 Z-5 R1 I2 F100': I has no meaning with G81
; dialect iso
G81 X1 Z-5 R1 I2 F100
M30
