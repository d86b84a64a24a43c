; P-ERR-21814 iso_peck_negative.nc line 3 column 15 'G73 X1 Z-5 R1 Q-2 F100': G73: Q-2 must be greater than 0
; dialect iso
G73 X1 Z-5 R1 Q-2 F100
M30
