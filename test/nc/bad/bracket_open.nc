; P-ERR-21040 bracket_open.nc line 2 column 5 'N10 S[M3 REV100': '[' without ']'
N10 S[M3 REV100
M30
