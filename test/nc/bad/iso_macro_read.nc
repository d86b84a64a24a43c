; P-ERR-21800 iso_macro_read.nc line 3 column 4 'G0 X#100': 'X#100': macro variables and expressions are not available in the vocabulary iso
; dialect iso
G0 X#100
M30
