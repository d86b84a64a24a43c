; P-ERR-21033 iso_arc_without_centre.nc line 3 column 1 'G2 X10 F100': G02 without a centre (I, J) and without a radius (R)
; dialect iso
G2 X10 F100
M30
