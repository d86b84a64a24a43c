; P-ERR-21053 code_value_fraction.nc line 2 column 4 'X1 M52=1.5': the value of M52 must be an integer, it is 1.5
X1 M52=1.5
M30
