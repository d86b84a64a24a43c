; P-ERR-21423 array_index_with_decimals.nc line 5 column 3 'X[V.L.A[0.5]]': the index of V.L.A needs an integer, not 0.5
#VAR
V.L.A[4]
#ENDVAR
X[V.L.A[0.5]]
M30
