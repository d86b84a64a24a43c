; P-ERR-21820 iso_two_points.nc line 3 column 4 'G0 X1.5.2': 'X1.5.2' is not a letter with a number; numbers have no blanks between their digits
; dialect iso
G0 X1.5.2
M30
