; P-ERR-20685 iso_dwell_with_axis.nc line 3 column 7 'G4 P1 Y5': G04 must be alone in its block, not with Y
; dialect iso
G4 P1 Y5
M30
