; P-ERR-21431 array_as_computed_parameter.nc line 6 column 1 'P[P1] = 3': P10 is an array and needs 1 index
#VAR
P10[5]
#ENDVAR
P1 = 10
P[P1] = 3
M30
