; P-ERR-21401 expression_not_closed.nc line 3 column 2 'X[P1+2': '[' is not closed in its line
P1=3
X[P1+2
M30
