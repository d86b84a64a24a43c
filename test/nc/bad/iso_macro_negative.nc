; P-ERR-21800 iso_macro_negative.nc line 3 column 4 'G1 X-#5 F100': 'X-#5': macro variables and expressions are not available in the vocabulary iso
; dialect iso
G1 X-#5 F100
M30
