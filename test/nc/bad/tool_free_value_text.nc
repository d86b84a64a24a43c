; P-ERR-21405 tool_free_value_text.nc line 3 column 5 'N10 V.G.WZ[2].P[1] = "long"': the value of a tool is a text where a number is needed
; tools milling
N10 V.G.WZ[2].P[1] = "long"
M30
