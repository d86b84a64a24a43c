; P-ERR-21010 computed_tool_with_decimals.nc line 2 column 1 'T[1.5]': T1.5 must be an integer from 0 to 999999999
T[1.5]
M30
