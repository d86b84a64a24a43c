; P-ERR-21442 value_of_type.nc line 5 column 1 'V.P.A=255.5': V.P.A of type UNS08 takes 0 ... 255, not 255.5
#VAR
V.P.A : UNS08
#ENDVAR
V.P.A=255.5
M30
