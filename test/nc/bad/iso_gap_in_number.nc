; P-ERR-21820 iso_gap_in_number.nc line 3 column 7 'G0 X1 0': '0' is not a letter with a number; numbers have no blanks between their digits
; dialect iso
G0 X1 0
M30
