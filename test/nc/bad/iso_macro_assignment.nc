; P-ERR-21800 iso_macro_assignment.nc line 3 column 1 '#100=5': '#100': macro variables and expressions are not available in the vocabulary iso
; dialect iso
#100=5
M30
