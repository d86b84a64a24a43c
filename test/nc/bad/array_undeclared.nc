; P-ERR-20921 array_undeclared.nc line 2 column 1 'P5[3]=1': P5 is used as an array but was not declared with #VAR
P5[3]=1
M30
