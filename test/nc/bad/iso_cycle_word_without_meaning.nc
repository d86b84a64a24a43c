; P-ERR-21013 iso_cycle_word_without_meaning.nc line 3 column 15 'G81 X1 Z-5 R1 Q2 F100': Q has no meaning with G81
; dialect iso
G81 X1 Z-5 R1 Q2 F100
M30
