; P-ERR-21435 active_offset_of_variable_axis.nc line 2 column 1 'V.G.NP_AKT.V.Q=5': the channel has no axis Q; it has: X, Y, Z
V.G.NP_AKT.V.Q=5
M30
