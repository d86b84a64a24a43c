; P-ERR-20685 iso_dwell_with_function.nc line 3 column 7 'G4 P1 M8': G04 must be alone in its block, not with M08
; dialect iso
G4 P1 M8
M30
