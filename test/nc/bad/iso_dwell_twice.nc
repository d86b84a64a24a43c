; P-ERR-20685 iso_dwell_twice.nc line 3 column 7 'G4 P1 X1': G04 must be alone in its block, not with X
; dialect iso
G4 P1 X1
M30
