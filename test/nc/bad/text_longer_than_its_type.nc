; P-ERR-21433 text_longer_than_its_type.nc line 3 column 21 'V.P.T : STRING[3] = "abcd"': the text for V.P.T has 4 characters, the limit is 3
#VAR
V.P.T : STRING[3] = "abcd"
#ENDVAR
M30
