; P-ERR-21402 expression_unknown_name.nc line 2 column 4 'P1=PIE': 'PIE' is no function, constant or variable; did you mean PI?
P1=PIE
M30
