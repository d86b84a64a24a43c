; P-ERR-21581 variables_not_closed.nc line 2 column 1 '#VAR': #VAR of line 2 has no #ENDVAR
#VAR
V.P.A
M30
