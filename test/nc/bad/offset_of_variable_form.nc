; P-ERR-21439 offset_of_variable_form.nc line 2 column 1 'V.G.NP[1].X=5': 'V.G.NP[1].X' is not complete or has too much: it is written V.G.NP[<index>].V.<axis>
V.G.NP[1].X=5
M30
