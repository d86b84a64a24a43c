; P-ERR-21401 tool_data_close.nc line 4 column 12 '#TOOL DATA [1': '[' is not closed in its line
; machine X Y Z / S
; tools milling
#TOOL DATA [1
M30
