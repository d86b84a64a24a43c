; P-ERR-21435 tool_variable_without_table.nc line 2 column 10 'N10 P1 = V.G.WZ[1].R': the channel has no compensation data D1; it has: none
N10 P1 = V.G.WZ[1].R
M30
