; P-ERR-21052 code_value_of_gear.nc line 2 column 4 'X1 M41=5': M41 takes no value
X1 M41=5
M30
