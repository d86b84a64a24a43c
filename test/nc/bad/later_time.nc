; P-ERR-21050 later_time.nc line 2 column 1 'G93 F5': G93 is not available yet: the time of a block
G93 F5
M30
