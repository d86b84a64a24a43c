; P-ERR-21052 code_value_not_taken.nc line 2 column 1 'G54=2': G54 takes no value
G54=2
M30
