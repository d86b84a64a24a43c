; P-ERR-21050 iso_fine_boring.nc line 3 column 1 'G76 X1 Z-5 R1 Q1 F100': G76 is not available yet: boring with an oriented spindle
; dialect iso
G76 X1 Z-5 R1 Q1 F100
M30
