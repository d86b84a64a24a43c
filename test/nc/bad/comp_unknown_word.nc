; P-ERR-21097 comp_unknown_word.nc line 2 column 21 'N10 X[COMP ON FRICT CROSS]': 'CROSS' is not available after COMP of axis X; known are: ON, OFF, FRICT
N10 X[COMP ON FRICT CROSS]
M30
