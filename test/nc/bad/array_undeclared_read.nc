; P-ERR-20921 array_undeclared_read.nc line 2 column 4 'P1=P5[3]': P5 is used as an array but was not declared with #VAR
P1=P5[3]
M30
