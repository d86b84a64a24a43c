; P-ERR-21808 iso_g53_with_arc.nc line 5 column 1 'G53 X0': G53 moves with G00 or G01 only
; dialect iso
G1 F100 X5
G3 X6 R3
G53 X0
M30
