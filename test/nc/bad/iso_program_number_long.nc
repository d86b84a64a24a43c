; P-ERR-21803 iso_program_number_long.nc line 3 column 1 'O123456789': 'O123456789' is not a program number; a line O1234 has nothing else but a comment
; dialect iso
O123456789
M30
