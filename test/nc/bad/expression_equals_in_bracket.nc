; P-ERR-21409 expression_equals_in_bracket.nc line 2 column 7 'P1=[P2=3]': '=' assigns; two values are compared by '=='
P1=[P2=3]
M30
