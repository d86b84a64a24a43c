; P-ERR-21650 tool_unknown.nc line 3 column 5 'N10 T4': tool T4 is not in the tool table; known are: T1, T2, T3, T7
; tools milling
N10 T4
M30
