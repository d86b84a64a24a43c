; P-ERR-21050 later_mirror.nc line 2 column 1 'G351 X5': G351 is not available yet: mirroring of single axes
G351 X5
