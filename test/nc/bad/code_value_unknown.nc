; P-ERR-20131 code_value_unknown.nc line 2 column 1 'G222=5': unknown G function G222=5
G222=5
M30
