; P-ERR-21032 centre_not_in_plane_zx.nc line 2 column 17 'N10 G18 G03 Z10 J5 F600': centre word J is not in the plane G18 (ZX)
N10 G18 G03 Z10 J5 F600
M30
