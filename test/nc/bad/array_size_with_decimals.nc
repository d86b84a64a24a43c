; P-ERR-21423 array_size_with_decimals.nc line 3 column 7 'V.P.A[2.5]': the size of V.P.A needs an integer, not 2.5
#VAR
V.P.A[2.5]
#ENDVAR
M30
