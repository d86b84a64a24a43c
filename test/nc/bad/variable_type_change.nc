; P-ERR-21432 variable_type_change.nc line 3 column 1 'V.P.A="five"': V.P.A holds a number and takes no text
V.P.A=5
V.P.A="five"
M30
