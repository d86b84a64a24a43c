; P-ERR-21431 array_read_as_parameter.nc line 5 column 7 'G00 X[P10]': P10 is an array and needs 1 index
#VAR
P10[5]
#ENDVAR
G00 X[P10]
M30
