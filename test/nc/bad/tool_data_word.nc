; P-ERR-21615 tool_data_word.nc line 4 column 12 '#TOOL DATA 5': '5' is not available in #TOOL DATA; its syntax is #TOOL DATA [basic, sister, variant], of which one to three are given
; machine X Y Z / S
; tools milling
#TOOL DATA 5
M30
