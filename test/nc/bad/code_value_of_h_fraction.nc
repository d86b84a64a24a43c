; P-ERR-21053 code_value_of_h_fraction.nc line 3 column 1 'H7=P1': the value of H07 must be an integer, it is 0.5
P1 = 0.5
H7=P1
M30
