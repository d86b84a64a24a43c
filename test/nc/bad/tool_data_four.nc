; P-ERR-21615 tool_data_four.nc line 4 column 22 '#TOOL DATA [1, 0, 0, 0]': '0' is not available in #TOOL DATA; its syntax is #TOOL DATA [basic, sister, variant], of which one to three are given
; machine X Y Z / S
; tools milling
#TOOL DATA [1, 0, 0, 0]
M30
