; P-ERR-20738 tool_written_with_d.nc line 4 column 31 'N20 V.G.WZ_AKT.L = 25 G00 X10 D2': V.G.WZ_AKT.L is written in a block with D2, which selects other data
; tools milling
N10 D1
N20 V.G.WZ_AKT.L = 25 G00 X10 D2
M30
