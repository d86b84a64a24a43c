; P-ERR-20296 tool_data_unknown.nc line 5 column 5 'N30 D4 G00 Z5': D4: the tool table has no compensation data D4; known are: D1, D2, D3, D7, D13
; tools milling
N10 T1 D1
N20 G00 Z0
N30 D4 G00 Z5
M30
