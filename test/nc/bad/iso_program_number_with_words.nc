; P-ERR-21803 iso_program_number_with_words.nc line 3 column 1 'O0012 G21': 'O0012 G21' is not a program number; a line O1234 has nothing else but a comment
; dialect iso
O0012 G21
M30
