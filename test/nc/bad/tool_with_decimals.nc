; P-ERR-21010 tool_with_decimals.nc line 2 column 5 'N10 T1.5': T1.5 must be an integer from 0 to 999999999
N10 T1.5
M30
