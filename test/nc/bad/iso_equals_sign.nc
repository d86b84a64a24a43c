; P-ERR-21820 iso_equals_sign.nc line 3 column 4 'G0 X=5': 'X' is not a letter with a number; numbers have no blanks between their digits
; dialect iso
G0 X=5
M30
