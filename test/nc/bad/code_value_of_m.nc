; P-ERR-21052 code_value_of_m.nc line 2 column 1 'M8=5': M08 takes no value
M8=5
M30
