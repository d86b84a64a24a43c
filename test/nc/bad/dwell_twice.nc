; P-ERR-20013 dwell_twice.nc line 2 column 11 'N10 G04 5 F2': dwell time given directly and by F
N10 G04 5 F2
M30
