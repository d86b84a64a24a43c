; P-ERR-21042 spindle_weight_twice.nc line 2 column 15 'N10 S[G136=80 G136=80]': G136 twice in one block
N10 S[G136=80 G136=80]
M30
