; P-ERR-21096 comp_not_first.nc line 2 column 7 'N10 X[ON COMP FRICT]': the brackets of axis X begin with COMP, not with 'ON'
N10 X[ON COMP FRICT]
M30
