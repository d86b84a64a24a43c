; P-ERR-20685 dwell_with_spindle_feedforward.nc line 2 column 11 'N10 G04 5 S[G135]': G04 must be alone in its block, not with S
N10 G04 5 S[G135]
M30
