; P-ERR-21410 expression_hexadecimal.nc line 2 column 4 'P1='H12G'': 'H12G' is no hexadecimal or binary number, as in 'H2FF' or 'B1001'
P1='H12G'
M30
