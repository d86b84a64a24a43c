; P-ERR-21030 iso_dwell_is_negative.nc line 3 column 4 'G4 P-1': dwell time of -1 s is negative
; dialect iso
G4 P-1
M30
