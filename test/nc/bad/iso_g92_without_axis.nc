; P-ERR-21602 iso_g92_without_axis.nc line 3 column 1 'G92': G92 without an axis
; dialect iso
G92
M30
