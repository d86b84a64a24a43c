; P-ERR-21579 assignment_without_value.nc line 2 column 1 'P1': P1 without '=' and a value
P1
M30
