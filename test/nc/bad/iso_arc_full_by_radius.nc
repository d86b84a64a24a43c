; P-ERR-20034 iso_arc_full_by_radius.nc line 3 column 7 'G2 X0 R5 F100': a full circle needs its centre: with R alone start and target must differ
; dialect iso
G2 X0 R5 F100
M30
