; P-ERR-21400 expression_no_operand.nc line 2 column 6 'X[P1+]': an expression needs a value here, not ']'
X[P1+]
M30
