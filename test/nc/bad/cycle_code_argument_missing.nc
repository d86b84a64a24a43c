; P-ERR-20925 g81.nc line 3 column 12 '$IF @P1 >= @P2': parameter @P2 has no value yet
F100
G81[-10]
M30
