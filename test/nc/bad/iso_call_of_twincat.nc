; P-ERR-21820 iso_call_of_twincat.nc line 3 column 1 'LL UP': 'L' is not a letter with a number; numbers have no blanks between their digits
; dialect iso
LL UP
M30
