; P-ERR-21807 iso_peck_missing.nc line 3 column 1 'G83 X1 Z-5 R1 F100': G83 without Q: the depth of a peck
; dialect iso
G83 X1 Z-5 R1 F100
M30
