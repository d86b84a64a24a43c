; P-ERR-21435 offset_of_variable_unknown.nc line 2 column 1 'V.G.NP[97].V.X=5': the channel has no zero offset 97; it has: 0 to 96
V.G.NP[97].V.X=5
M30
