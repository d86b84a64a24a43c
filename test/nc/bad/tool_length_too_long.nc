; P-ERR-21441 tool_length_too_long.nc line 3 column 5 'N10 V.G.WZ[1].L = 300000': value 300000 of the tool length is not within -214748 ... 214748
; tools milling
N10 V.G.WZ[1].L = 300000
M30
