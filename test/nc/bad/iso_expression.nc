; P-ERR-21800 iso_expression.nc line 3 column 4 'G0 X[1+2]': 'X[1+2]': macro variables and expressions are not available in the vocabulary iso
; dialect iso
G0 X[1+2]
M30
