; P-ERR-21807 iso_depth_missing.nc line 3 column 1 'G81 X1 R5 F100': G81 without Z: the bottom of the hole
; dialect iso
G81 X1 R5 F100
M30
