; P-ERR-21589 declaration_string_without_length.nc line 3 column 15 'V.P.A : STRING': STRING needs its length in brackets, 1 to 126
#VAR
V.P.A : STRING
#ENDVAR
M30
