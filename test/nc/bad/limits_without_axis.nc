; P-ERR-21602 limits_without_axis.nc line 2 column 1 'G98': G98 without an axis
G98
M30
