; P-ERR-21572 declaration_words_after.nc line 3 column 11 'V.P.A = 5 6': '6' after a declaration: it must be alone in its block
#VAR
V.P.A = 5 6
#ENDVAR
M30
