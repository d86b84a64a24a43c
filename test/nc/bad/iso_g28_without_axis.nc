; P-ERR-21602 iso_g28_without_axis.nc line 3 column 1 'G28': G28 without an axis
; dialect iso
G28
M30
