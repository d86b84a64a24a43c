; P-ERR-21652 tool_length_without_axis.nc line 4 column 9 'N10 G18 D6': the tool of D6 is 30 mm long in axis Y (G18), which this channel does not have
; machine X Z / S
; tools turning
N10 G18 D6
M30
