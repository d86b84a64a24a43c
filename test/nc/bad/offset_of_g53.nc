; P-ERR-21622 offset_of_g53.nc line 2 column 1 'V.G.NP[0].V.X = 5': V.G.NP[0]: G53 selects no zero offset, so that index 0 has no values (P-ZERO-00001)
V.G.NP[0].V.X = 5
M30
