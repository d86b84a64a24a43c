; P-ERR-21804 iso_word_of_two_call.nc line 3 column 7 'G54.1 P1 M98': P belongs to G54.1 and to M98; write them in two blocks
; dialect iso
G54.1 P1 M98
M30
