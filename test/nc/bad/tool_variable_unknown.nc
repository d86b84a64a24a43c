; P-ERR-21435 tool_variable_unknown.nc line 3 column 10 'N10 P1 = V.G.WZ[4].L': the channel has no compensation data D4; it has: D1, D2, D3, D7, D13
; tools milling
N10 P1 = V.G.WZ[4].L
M30
