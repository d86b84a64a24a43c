; P-ERR-21808 iso_g53_in_cycle.nc line 4 column 1 'G53 X0': G53 moves with G00 or G01 only
; dialect iso
G81 X1 Z-1 R1 F100
G53 X0
M30
