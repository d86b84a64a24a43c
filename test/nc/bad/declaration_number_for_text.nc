; P-ERR-21406 declaration_number_for_text.nc line 3 column 21 'V.P.A : STRING[5] = 5': a text is needed here, not a number
#VAR
V.P.A : STRING[5] = 5
#ENDVAR
M30
