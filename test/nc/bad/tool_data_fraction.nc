; P-ERR-20863 tool_data_fraction.nc line 5 column 16 '#TOOL DATA [P1 / 2]': #TOOL DATA: tool number 1.5 must be an integer from 0 to 999999999
; machine X Y Z / S
; tools milling
P1 = 3
#TOOL DATA [P1 / 2]
M30
