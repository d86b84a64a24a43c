; P-ERR-21032 iso_arc_centre_out_of_plane.nc line 3 column 8 'G2 X10 K5 F100': centre word K is not in the plane G17 (XY)
; dialect iso
G2 X10 K5 F100
M30
