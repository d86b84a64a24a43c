; P-ERR-21012 offset_group_twice.nc line 2 column 5 'G54 G55': G54 and G55 belong to one group (zero offset) and cannot be in one block
G54 G55
M30
