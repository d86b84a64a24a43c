; P-ERR-21013 iso_word_without_meaning.nc line 3 column 7 'G0 X5 Q2': Q has no meaning with G00
; dialect iso
G0 X5 Q2
M30
