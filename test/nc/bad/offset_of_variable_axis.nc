; P-ERR-21435 offset_of_variable_axis.nc line 2 column 1 'V.G.NP[1].V.Q=5': the channel has no axis Q; it has: X, Y, Z
V.G.NP[1].V.Q=5
M30
