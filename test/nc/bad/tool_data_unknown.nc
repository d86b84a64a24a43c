; P-ERR-20296 tool_data_unknown.nc line 4 column 1 '#TOOL DATA [5]': D5: the tool table has no compensation data D5; known are: D1, D2, D3, D7, D13
; machine X Y Z / S
; tools milling
#TOOL DATA [5]
M30
