; P-ERR-21433 text_too_long.nc line 4 column 12 'V.P.T=V.P.T+V.P.T': the text for + has 1280 characters, the limit is 1000
V.P.T="0123456789"
$FOR P1=1,7,1
V.P.T=V.P.T+V.P.T
$ENDFOR
M30
