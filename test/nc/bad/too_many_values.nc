; P-ERR-21434 too_many_values.nc line 3 column 1 'V.P.A[1000][101]': V.P.A would be value 101000 of the channel, the limit is 100000
#VAR
V.P.A[1000][101]
#ENDVAR
M30
