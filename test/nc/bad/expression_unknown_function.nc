; P-ERR-21402 expression_unknown_function.nc line 2 column 4 'P1=SINUS[30]': 'SINUS' is no function, constant or variable; did you mean SIN?
P1=SINUS[30]
M30
