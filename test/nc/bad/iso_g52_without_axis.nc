; P-ERR-21602 iso_g52_without_axis.nc line 3 column 1 'G52': G52 without an axis
; dialect iso
G52
M30
