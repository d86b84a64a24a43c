; P-ERR-21650 tool_with_t_without_data.nc line 4 column 5 'N20 T[10]': tool T10 is not in the tool table; known are: T1, T2, T3, T7
; tools with_t
N10 T2
N20 T[10]
M30
