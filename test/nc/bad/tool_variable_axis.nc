; P-ERR-21435 tool_variable_axis.nc line 3 column 10 'N10 P1 = V.G.WZ[1].V.W': the channel has no axis W; it has: X, Y, Z
; tools milling
N10 P1 = V.G.WZ[1].V.W
M30
