; P-ERR-21652 tool_length_plane_without_axis.nc line 6 column 5 'N30 G18': the tool of D6 is 30 mm long in axis Y (G18), which this channel does not have
; machine X Z / S
; tools turning
N10 D6
N20 G00 Z0
N30 G18
M30
