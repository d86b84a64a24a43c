; P-ERR-21405 offset_of_variable_with_text.nc line 2 column 1 'V.G.NP[1].V.X="5"': the value of an offset is a text where a number is needed
V.G.NP[1].V.X="5"
M30
