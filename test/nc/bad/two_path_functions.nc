; P-ERR-21012 two_path_functions.nc line 2 column 9 'N10 G00 G01 X10 F600': G00 and G01 belong to one group (path) and cannot be in one block
N10 G00 G01 X10 F600
M30
