; P-ERR-21587 declaration_list.nc line 3 column 12 'V.P.A[2] = 5': the first values of the array V.P.A need brackets: = [1, 2, 3]
#VAR
V.P.A[2] = 5
#ENDVAR
M30
