; P-ERR-21032 centre_not_in_plane.nc line 2 column 16 'N10 G02 X10 I5 K2 F600': centre word K is not in the plane G17 (XY)
N10 G02 X10 I5 K2 F600
M30
