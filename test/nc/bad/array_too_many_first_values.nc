; P-ERR-21437 array_too_many_first_values.nc line 3 column 17 'V.P.A[2] = [1,2,3]': V.P.A has 2 elements, but 3 first values
#VAR
V.P.A[2] = [1,2,3]
#ENDVAR
M30
