; P-ERR-21012 computed_group_twice.nc line 2 column 5 'G01 G[0] X5': G01 and G00 belong to one group (path) and cannot be in one block
G01 G[0] X5
M30
