; P-ERR-21428 variable_not_an_array.nc line 3 column 3 'X[V.P.A[1]]': V.P.A is not an array
V.P.A=5
X[V.P.A[1]]
M30
