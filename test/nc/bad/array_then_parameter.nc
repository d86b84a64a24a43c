; P-ERR-21431 array_then_parameter.nc line 6 column 1 'P10 = 1': P10 is an array and needs 1 index
#VAR
P10[5]
#ENDVAR
P10[2] = 4
P10 = 1
M30
