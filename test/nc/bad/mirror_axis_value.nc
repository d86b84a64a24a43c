; P-ERR-20860 mirror_axis_value.nc line 2 column 10 'G351 X-1 Y2': G351 with Y2: -1 mirrors axis Y, 1 does not
G351 X-1 Y2
M30
