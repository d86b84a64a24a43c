; P-ERR-20131 computed_code_unknown.nc line 2 column 1 'G[200+22]': unknown G function G[200+22]
G[200+22]
M30
