; P-ERR-21443 parameter_then_array.nc line 4 column 1 'P10[5]': P10 has a value as a parameter and cannot be an array, too
P10 = 1
#VAR
P10[5]
#ENDVAR
M30
