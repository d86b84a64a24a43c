; P-ERR-21582 variables_end_stray.nc line 2 column 1 '#ENDVAR': #ENDVAR without #VAR before it
#ENDVAR
M30
