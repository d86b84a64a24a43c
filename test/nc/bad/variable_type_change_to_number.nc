; P-ERR-21432 variable_type_change_to_number.nc line 3 column 1 'V.P.A=5': V.P.A holds a text and takes no number
V.P.A="five"
V.P.A=5
M30
