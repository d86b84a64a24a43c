; P-ERR-21023 iso_dwell_without_time.nc line 3 column 1 'G4': G04 without a time
; dialect iso
G4
M30
