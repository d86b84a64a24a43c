; P-ERR-21050 g106.nc line 2 column 1 'G106 X1': G106 is not available yet: measuring without a stop at the signal
G106 X1
M30
