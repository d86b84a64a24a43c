; P-ERR-21651 tool_data_invalid.nc line 4 column 5 'N20 D7': D7: compensation data D7 are not valid (P-TOOL-00005 wz[7].gueltig)
; tools milling
N10 G00 X1
N20 D7
M30
