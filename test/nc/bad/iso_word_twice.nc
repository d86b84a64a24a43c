; P-ERR-20203 iso_word_twice.nc line 3 column 7 'G0 X1 X2': axis X twice in one block: 1 and 2
; dialect iso
G0 X1 X2
M30
