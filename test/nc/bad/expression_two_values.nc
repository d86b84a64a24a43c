; P-ERR-21400 expression_two_values.nc line 2 column 7 'P1=[3 4]': an expression needs a value here, not '4'
P1=[3 4]
M30
