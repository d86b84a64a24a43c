; P-ERR-21820 iso_letter_alone.nc line 3 column 4 'G0 X': 'X' is not a letter with a number; numbers have no blanks between their digits
; dialect iso
G0 X
M30
