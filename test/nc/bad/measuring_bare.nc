; P-ERR-21100 measuring_bare.nc line 3 column 1 'G100': G100 without an axis: its axis words are the end of the measuring run
N10 G01 X5 F300
G100
M30
