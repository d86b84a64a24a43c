; P-ERR-21405 tool_length_text.nc line 3 column 5 'N10 V.G.WZ_AKT.L = "long"': the value of a tool length is a text where a number is needed
; tools milling
N10 V.G.WZ_AKT.L = "long"
M30
