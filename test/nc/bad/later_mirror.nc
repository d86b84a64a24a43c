; P-ERR-21050 later_mirror.nc line 2 column 1 'G24 X5': G24 is not available yet: mirroring of single axes
G24 X5
