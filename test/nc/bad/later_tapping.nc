; P-ERR-21050 later_tapping.nc line 2 column 1 'G63 Z-10': G63 is not available yet: tapping
G63 Z-10
M30
