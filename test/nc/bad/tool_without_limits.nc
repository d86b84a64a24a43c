; P-ERR-20296 tool_without_limits.nc line 4 column 4 'T9 D9': D9: the tool table has no compensation data D9; known are: D1, D2
; tools limits
T5 D1
T9 D9
M30
