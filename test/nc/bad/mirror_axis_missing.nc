; P-ERR-21602 mirror_axis_missing.nc line 2 column 1 'G351': G351 without an axis
G351
M30
