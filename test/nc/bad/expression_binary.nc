; P-ERR-21410 expression_binary.nc line 2 column 4 'P1='B102'': 'B102' is no hexadecimal or binary number, as in 'H2FF' or 'B1001'
P1='B102'
M30
