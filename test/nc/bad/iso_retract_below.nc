; P-ERR-21813 iso_retract_below.nc line 3 column 1 'G81 X1 Z5 R1 F100': G81: the bottom of the hole 5 mm is beyond the retract plane R 1 mm
; dialect iso
G81 X1 Z5 R1 F100
M30
