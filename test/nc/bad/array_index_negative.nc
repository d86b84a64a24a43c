; P-ERR-21430 array_index_negative.nc line 5 column 1 'P5[-1]=1': index -1 of P5 is not within 0 ... 3
#VAR
P5[4]
#ENDVAR
P5[-1]=1
M30
