; P-ERR-20908 deleted_parameter.nc line 2 column 9 '#DELETE P1': 'P1' between #VAR and #ENDVAR: only V.P., V.L., V.S., V.CYC. and P are declared
#DELETE P1
M30
