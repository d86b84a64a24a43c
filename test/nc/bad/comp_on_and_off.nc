; P-ERR-21012 comp_on_and_off.nc line 2 column 15 'N10 X[COMP ON OFF FRICT]': ON and OFF belong to one group (COMP of axis X) and cannot be in one block
N10 X[COMP ON OFF FRICT]
M30
