; P-ERR-21033 iso_radius_is_not_modal.nc line 5 column 1 'X15': G02 without a centre (I, J) and without a radius (R)
; dialect iso
G1 F100 X5
G2 X10 R5
X15
M30
