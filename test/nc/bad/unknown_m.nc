; P-ERR-20160 unknown_m.nc line 2 column 5 'N10 M1000': unknown M function M1000
N10 M1000
M30
