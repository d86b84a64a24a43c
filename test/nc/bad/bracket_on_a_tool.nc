; P-ERR-21001 bracket_on_a_tool.nc line 2 column 6 'N10 T[M3]': unexpected character '['
N10 T[M3]
M30
