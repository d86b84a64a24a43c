; P-ERR-21589 declaration_string_length.nc line 3 column 15 'V.P.A : STRING[200]': STRING needs its length in brackets, 1 to 126
#VAR
V.P.A : STRING[200]
#ENDVAR
M30
