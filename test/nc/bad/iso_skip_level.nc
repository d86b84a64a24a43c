; P-ERR-21011 iso_skip_level.nc line 3 column 2 '/0 G0 X1': block skip /0 must be /1 to /9
; dialect iso
/0 G0 X1
M30
