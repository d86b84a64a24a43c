; P-ERR-21650 tool_prep_unknown.nc line 4 column 1 '#TOOL PREP [9]': tool T9 is not in the tool table; known are: T1, T2, T3, T7
; machine X Y Z / S
; tools milling
#TOOL PREP [9]
M30
