; P-ERR-21602 iso_g10_without_axis.nc line 3 column 1 'G10 L2 P1': G10 without an axis
; dialect iso
G10 L2 P1
M30
