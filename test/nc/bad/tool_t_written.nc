; P-ERR-21408 tool_t_written.nc line 3 column 5 'N10 V.G.T_AKT = 5': V.G.T_AKT can be read only
; tools milling
N10 V.G.T_AKT = 5
M30
