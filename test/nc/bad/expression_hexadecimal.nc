; P-ERR-21410 expression_hexadecimal.nc line 2 column 4 'P1='H12G'': ''H12G'' is no hexadecimal number
P1='H12G'
M30
