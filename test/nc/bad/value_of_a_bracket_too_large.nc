; P-ERR-21441 value_of_a_bracket_too_large.nc line 2 column 1 'S[M3 REV=DEXP[10]]': value 10000000000 of S is not within -999999999 ... 999999999
S[M3 REV=DEXP[10]]
M30
