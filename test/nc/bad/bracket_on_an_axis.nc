; P-ERR-21001 bracket_on_an_axis.nc line 2 column 6 'N10 X[10]': unexpected character '['
N10 X[10]
M30
