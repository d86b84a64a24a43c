; P-ERR-21037 spindle_feedforward_and_speed.nc line 2 column 14 'N10 M3 S1000 S[G135]': spindle S is programmed twice in one block
N10 M3 S1000 S[G135]
M30
