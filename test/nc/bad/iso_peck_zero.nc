; P-ERR-21814 iso_peck_zero.nc line 3 column 15 'G83 X1 Z-5 R1 Q0 F100': G83: Q0 must be greater than 0
; dialect iso
G83 X1 Z-5 R1 Q0 F100
M30
