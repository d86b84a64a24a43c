; P-ERR-21653 tool_value_fraction.nc line 3 column 5 'N10 V.G.WZ_AKT.P[0.5] = 1': value 0.5 of a tool must be an integer from 0 to 59
; tools milling
N10 V.G.WZ_AKT.P[0.5] = 1
M30
