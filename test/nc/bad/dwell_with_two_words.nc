; P-ERR-20685 dwell_with_two_words.nc line 2 column 12 'N10 G04 X2 F2': G04 must be alone in its block, not with F
N10 G04 X2 F2
M30
