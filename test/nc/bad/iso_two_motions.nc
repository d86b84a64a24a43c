; P-ERR-21012 iso_two_motions.nc line 3 column 4 'G0 G1 X5 F100': G00 and G01 belong to one group (path) and cannot be in one block
; dialect iso
G0 G1 X5 F100
M30
