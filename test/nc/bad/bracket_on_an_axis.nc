; P-ERR-21096 bracket_on_an_axis.nc line 2 column 7 'N10 X[10]': the brackets of axis X begin with COMP, not with '10'
N10 X[10]
M30
