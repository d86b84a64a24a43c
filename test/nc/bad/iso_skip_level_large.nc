; P-ERR-21011 iso_skip_level_large.nc line 3 column 2 '/10 G0 X1': block skip /10 must be /1 to /9
; dialect iso
/10 G0 X1
M30
