; P-ERR-21052 code_value_of_m.nc line 2 column 1 'M3=5': M03 takes no value
M3=5
M30
