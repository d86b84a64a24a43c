; P-ERR-21652 tool_length_written_without_axis.nc line 5 column 5 'N20 V.G.WZ_AKT.L = 12.5': the tool of D5 is 12.5 mm long in axis Y (G18), which this channel does not have
; machine X Z / S
; tools turning
N10 G18 D5
N20 V.G.WZ_AKT.L = 12.5
M30
