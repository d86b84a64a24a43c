; P-ERR-21013 iso_arc_words_behind_g80.nc line 4 column 1 'I5': I has no meaning with G80
; dialect iso
G80
I5
M30
