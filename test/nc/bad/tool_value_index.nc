; P-ERR-21653 tool_value_index.nc line 3 column 10 'N10 P1 = V.G.WZ[1].P[60]': value 60 of a tool must be an integer from 0 to 59
; tools milling
N10 P1 = V.G.WZ[1].P[60]
M30
