; P-ERR-21616 tool_data_missing.nc line 4 column 11 '#TOOL DATA': #TOOL DATA without a tool number in brackets; its syntax is #TOOL DATA [basic, sister, variant], of which one to three are given
; machine X Y Z / S
; tools milling
#TOOL DATA
M30
