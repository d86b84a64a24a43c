; P-ERR-21010 tool_negative.nc line 2 column 5 'N10 D-1': D-1 must be an integer from 0 to 999999999
N10 D-1
M30
