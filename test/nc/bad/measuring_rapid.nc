; P-ERR-21012 measuring_rapid.nc line 2 column 9 'N10 G00 G100 X9': G00 and G100 belong to one group (path) and cannot be in one block
N10 G00 G100 X9
M30
