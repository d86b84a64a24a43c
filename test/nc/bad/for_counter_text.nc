; P-ERR-21432 for_counter_text.nc line 3 column 6 '$FOR V.P.T=1,2,1': V.P.T holds a text and takes no number
V.P.T="a"
$FOR V.P.T=1,2,1
$ENDFOR
M30
