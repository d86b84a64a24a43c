; P-ERR-21656 tool_by_t_without_table.nc line 3 column 1 'T7 M06': T7: there are no compensation data 7, the machine has no tool table (werkz_data, wz[7])
; tools with_t_none
T7 M06
M30
