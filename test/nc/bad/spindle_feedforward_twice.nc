; P-ERR-21042 spindle_feedforward_twice.nc line 2 column 12 'N10 S[G135 G135]': G135 twice in one block
N10 S[G135 G135]
M30
