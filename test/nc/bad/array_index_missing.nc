; P-ERR-21431 array_index_missing.nc line 5 column 3 'X[V.L.A]': V.L.A is an array and needs 1 index
#VAR
V.L.A[4]
#ENDVAR
X[V.L.A]
M30
