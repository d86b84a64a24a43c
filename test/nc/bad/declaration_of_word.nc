; P-ERR-20908 declaration_of_word.nc line 3 column 1 'G01 X5': 'G01' between #VAR and #ENDVAR: only V.P., V.L., V.S., V.CYC. and P are declared
#VAR
G01 X5
#ENDVAR
M30
