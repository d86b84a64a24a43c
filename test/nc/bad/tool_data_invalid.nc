; P-ERR-21651 tool_data_invalid.nc line 4 column 1 '#TOOL DATA [7, , 0]': D7: compensation data D7 are not valid (P-TOOL-00005 wz[7].gueltig)
; machine X Y Z / S
; tools milling
#TOOL DATA [7, , 0]
M30
