; P-ERR-21050 later_largest_speed.nc line 2 column 1 'G196 S2000': G196 is not available yet: constant cutting speed
G196 S2000
M30
