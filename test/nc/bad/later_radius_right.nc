; P-ERR-21050 later_radius_right.nc line 2 column 1 'G42 X10': G42 is not available yet: compensation of the tool radius
G42 X10
M30
