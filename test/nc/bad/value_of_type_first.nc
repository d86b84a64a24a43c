; P-ERR-21442 value_of_type_first.nc line 3 column 17 'V.P.A : SGN08 = -129': V.P.A of type SGN08 takes -128 ... 127, not -129
#VAR
V.P.A : SGN08 = -129
#ENDVAR
M30
