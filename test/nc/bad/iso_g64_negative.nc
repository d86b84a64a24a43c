; P-ERR-21810 iso_g64_negative.nc line 3 column 5 'G64 P-0.1': P-0.1: the tolerance of G64 is negative
; dialect iso
G64 P-0.1
M30
