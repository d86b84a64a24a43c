; P-ERR-21656 tool_without_table.nc line 6 column 1 'D7': D7: there are no compensation data 7, the machine has no tool table (werkz_data, wz[7])
; tools none
T7
D0
G00 X1
D7
M30
