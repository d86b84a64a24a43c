; P-ERR-21075 variables_with_words.nc line 2 column 6 '#VAR V.P.A': #VAR must be alone in its block, not with 'V.P.A'
#VAR V.P.A
#ENDVAR
M30
