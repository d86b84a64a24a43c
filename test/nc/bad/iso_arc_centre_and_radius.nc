; P-ERR-21024 iso_arc_centre_and_radius.nc line 3 column 8 'G2 X10 I5 R5 F100': circle centre (I) and radius (R) in one block
; dialect iso
G2 X10 I5 R5 F100
M30
