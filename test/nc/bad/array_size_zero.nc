; P-ERR-21436 array_size_zero.nc line 3 column 7 'V.P.A[0]': V.P.A cannot have 0 elements
#VAR
V.P.A[0]
#ENDVAR
M30
