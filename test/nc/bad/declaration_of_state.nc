; P-ERR-20908 declaration_of_state.nc line 3 column 1 'V.A.ABS.X': 'V.A.ABS.X' between #VAR and #ENDVAR: only V.P., V.L., V.S., V.CYC. and P are declared
#VAR
V.A.ABS.X
#ENDVAR
M30
