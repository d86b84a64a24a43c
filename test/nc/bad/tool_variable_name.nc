; P-ERR-21439 tool_variable_name.nc line 3 column 10 'N10 P1 = V.G.WZ_AKT.LEN': 'V.G.WZ_AKT.LEN' is not complete or has too much: it is written V.G.WZ_AKT.R or V.G.WZ_AKT.L or V.G.WZ_AKT.V.<axis> or V.G.WZ_AKT.P[<index>] or V.G.WZ_AKT.OK or V.G.WZ_AKT.ME or V.G.WZ_AKT.TYPE or V.G.WZ_AKT.SRK_ID or V.G.WZ_AKT.TOOL_FIXED or V.G.WZ_AKT.SPDL_AX_NR or V.G.WZ_AKT.WEAR_LENGTH or V.G.WZ_AKT.WEAR_RADIUS or V.G.WZ_AKT.WEAR.<axis>
; tools milling
N10 P1 = V.G.WZ_AKT.LEN
M30
