; P-ERR-21012 mirror_axis_twice.nc line 2 column 5 'G20 G351 X1': G20 and G351 belong to one group (mirror) and cannot be in one block
G20 G351 X1
M30
