; P-ERR-21803 iso_program_number_letters.nc line 3 column 1 'O12A': 'O12A' is not a program number; a line O1234 has nothing else but a comment
; dialect iso
O12A
M30
