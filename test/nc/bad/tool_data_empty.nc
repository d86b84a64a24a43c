; P-ERR-21616 tool_data_empty.nc line 4 column 17 '#TOOL DATA [, 1]': #TOOL DATA without the number of the basic tool; its syntax is #TOOL DATA [basic, sister, variant], of which one to three are given
; machine X Y Z / S
; tools milling
#TOOL DATA [, 1]
M30
