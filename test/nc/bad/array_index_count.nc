; P-ERR-21429 array_index_count.nc line 5 column 3 'X[V.P.A[1]]': V.P.A has 2 indices, not 1
#VAR
V.P.A[2][3]
#ENDVAR
X[V.P.A[1]]
M30
