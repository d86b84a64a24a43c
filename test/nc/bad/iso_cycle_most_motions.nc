; P-ERR-21816 iso_cycle_most_motions.nc line 3 column 1 'G83 X1 Z-5 R1 Q0.001 F100': G83 would make 18006 motions, the limit of a block is 10000
; dialect iso
G83 X1 Z-5 R1 Q0.001 F100
M30
