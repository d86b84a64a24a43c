; P-ERR-21800 iso_macro_named.nc line 3 column 1 '#<depth> = 3': '#<DEPTH>': macro variables and expressions are not available in the vocabulary iso
; dialect iso
#<depth> = 3
M30
