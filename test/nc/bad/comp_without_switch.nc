; P-ERR-21098 comp_without_switch.nc line 2 column 7 'N10 X[COMP FRICT]': COMP of axis X does not say ON or OFF
N10 X[COMP FRICT]
M30
