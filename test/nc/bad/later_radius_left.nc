; P-ERR-21050 later_radius_left.nc line 2 column 1 'G41 X10': G41 is not available yet: compensation of the tool radius
G41 X10
M30
