; P-ERR-20034 full_circle_by_radius.nc line 2 column 15 'N10 G02 X0 Y0 R10 F600': a full circle needs its centre: with R alone start and target must differ
N10 G02 X0 Y0 R10 F600
M30
