; P-ERR-21622 offset_of_g53_active.nc line 5 column 1 'V.G.NP_AKT.V.X = 5': V.G.NP_AKT: G53 selects no zero offset, so that index 0 has no values (P-ZERO-00001)
G54
V.G.NP_AKT.V.X = 5
G53
V.G.NP_AKT.V.X = 5
M30
