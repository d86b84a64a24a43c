; P-ERR-21588 declaration_type.nc line 3 column 9 'V.P.A : REAL32': type REAL32 is not known; known are: BOOLEAN, SGN08, UNS08, SGN16, UNS16, SGN32, UNS32, REAL64, STRING
#VAR
V.P.A : REAL32
#ENDVAR
M30
