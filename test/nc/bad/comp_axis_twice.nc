; P-ERR-21099 comp_axis_twice.nc line 2 column 22 'N10 X[COMP ON FRICT] X[COMP OFF FRICT]': COMP of axis X twice in one block
N10 X[COMP ON FRICT] X[COMP OFF FRICT]
M30
