; P-ERR-21807 iso_peck_of_another_cycle.nc line 4 column 1 'G73 X5': G73 without Q: the depth of a peck
; dialect iso
G83 X1 Z-5 R1 Q2 F100
G73 X5
M30
