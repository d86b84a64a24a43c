; P-ERR-21013 iso_word_of_m.nc line 3 column 9 'M3 S100 P2': P has no meaning with G00
; dialect iso
M3 S100 P2
M30
