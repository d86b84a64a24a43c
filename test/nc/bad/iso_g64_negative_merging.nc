; P-ERR-21810 iso_g64_negative_merging.nc line 3 column 10 'G64 P0.1 Q-1': Q-1: the tolerance of G64 is negative
; dialect iso
G64 P0.1 Q-1
M30
