; P-ERR-21579 assignment_without_value_variable.nc line 2 column 1 'V.P.DEPTH 5': V.P.DEPTH without '=' and a value
V.P.DEPTH 5
M30
