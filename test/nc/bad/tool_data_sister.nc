; P-ERR-21915 tool_data_sister.nc line 4 column 1 '#TOOL DATA [1, 2]': #TOOL DATA [1, 2]: the tool table has no sister tools and variants, their numbers must be 0 or missing
; machine X Y Z / S
; tools milling
#TOOL DATA [1, 2]
M30
