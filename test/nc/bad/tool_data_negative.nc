; P-ERR-21010 tool_data_negative.nc line 3 column 12 'N10 G00 X1 D-1': D-1 must be an integer from 0 to 999999999
; tools milling
N10 G00 X1 D-1
M30
