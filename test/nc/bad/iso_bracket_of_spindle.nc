; P-ERR-21800 iso_bracket_of_spindle.nc line 3 column 1 'S[M3 REV100]': 'S[M3 REV100]': macro variables and expressions are not available in the vocabulary iso
; dialect iso
S[M3 REV100]
M30
