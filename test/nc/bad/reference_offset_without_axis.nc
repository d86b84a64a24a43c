; P-ERR-21602 reference_offset_without_axis.nc line 2 column 1 'G92': G92 without an axis
G92
M30
