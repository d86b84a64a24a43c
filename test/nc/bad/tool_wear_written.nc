; P-ERR-21408 tool_wear_written.nc line 3 column 5 'N10 V.G.WZ[1].WEAR_LENGTH = -0.1': V.G.WZ can be read only
; tools milling
N10 V.G.WZ[1].WEAR_LENGTH = -0.1
M30
