; P-ERR-21441 value_of_a_word_too_large.nc line 2 column 1 'X[DEXP[9]]': value 1000000000 of X is not within -999999999 ... 999999999
X[DEXP[9]]
M30
