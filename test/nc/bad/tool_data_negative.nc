; P-ERR-20863 tool_data_negative.nc line 4 column 16 '#TOOL PREP [1, -1]': #TOOL PREP: tool number -1 must be an integer from 0 to 999999999
; machine X Y Z / S
; tools milling
#TOOL PREP [1, -1]
M30
