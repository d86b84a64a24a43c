; P-ERR-21433 text_in_a_variable_too_long.nc line 5 column 12 'V.P.U=V.P.U+V.P.T': the text for + has 1010 characters, the limit is 1000
V.P.T="0123456789"
V.P.U=""
$FOR P1=1,101,1
V.P.U=V.P.U+V.P.T
$ENDFOR
M30
