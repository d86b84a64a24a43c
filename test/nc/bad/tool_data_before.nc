; P-ERR-21075 tool_data_before.nc line 4 column 1 'G00 #TOOL DATA [1]': #TOOL DATA must be alone in its block, not with 'G00'
; machine X Y Z / S
; tools milling
G00 #TOOL DATA [1]
M30
