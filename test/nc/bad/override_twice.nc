; P-ERR-21042 override_twice.nc line 2 column 13 'N10 G166 X5 G166': G166 twice in one block
N10 G166 X5 G166
M30
