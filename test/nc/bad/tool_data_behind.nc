; P-ERR-21615 tool_data_behind.nc line 4 column 16 '#TOOL DATA [1] X5': 'X5' is not available in #TOOL DATA; its syntax is #TOOL DATA [basic, sister, variant], of which one to three are given
; machine X Y Z / S
; tools milling
#TOOL DATA [1] X5
M30
