; P-ERR-20909 declared_twice.nc line 4 column 1 'V.P.A': V.P.A is there already; #DELETE removes it
#VAR
V.P.A
V.P.A
#ENDVAR
M30
