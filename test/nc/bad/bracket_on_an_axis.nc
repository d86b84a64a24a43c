; P-ERR-21096 bracket_on_an_axis.nc line 2 column 7 'N10 X[MIST]': the brackets of axis X begin with COMP, not with 'MIST'
N10 X[MIST]
M30
