; P-ERR-21012 offset_group_twice_by_index.nc line 2 column 5 'G54 G159=3': G54 and G159 belong to one group (zero offset) and cannot be in one block
G54 G159=3
M30
