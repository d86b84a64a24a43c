; P-ERR-21807 iso_retract_missing.nc line 3 column 1 'G81 X1 Z-5 F100': G81 without R: the retract plane
; dialect iso
G81 X1 Z-5 F100
M30
