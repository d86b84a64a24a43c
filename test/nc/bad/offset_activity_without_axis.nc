; P-ERR-21602 offset_activity_without_axis.nc line 2 column 1 'G160=2': G160 without an axis
G160=2
M30
