; P-ERR-21405 declaration_text_for_number.nc line 3 column 17 'V.P.A : UNS32 = "5"': the first value is a text where a number is needed
#VAR
V.P.A : UNS32 = "5"
#ENDVAR
M30
