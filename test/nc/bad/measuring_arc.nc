; P-ERR-21012 measuring_arc.nc line 2 column 9 'N10 G02 G100 X9 I5 F300': G02 and G100 belong to one group (path) and cannot be in one block
N10 G02 G100 X9 I5 F300
M30
