; P-ERR-21098 comp_without_kind.nc line 2 column 8 'N10 X[ COMP OFF ]': COMP of axis X does not say what is switched (FRICT)
N10 X[ COMP OFF ]
M30
