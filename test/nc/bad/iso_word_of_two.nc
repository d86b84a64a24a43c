; P-ERR-21804 iso_word_of_two.nc line 3 column 21 'G54.1 G82 X1 Z-1 R1 P1': P belongs to G54.1 and to G82; write them in two blocks
; dialect iso
G54.1 G82 X1 Z-1 R1 P1
M30
