; P-ERR-21042 weights_twice.nc line 2 column 14 'N10 G136 X80 G136 Y70': G136 twice in one block
N10 G136 X80 G136 Y70
M30
