; P-ERR-21816 iso_cycle_most_holes.nc line 3 column 5 'G91 G81 X1 Z-5 R1 F100 L9999': G81 would make 59994 motions, the limit of a block is 10000
; dialect iso
G91 G81 X1 Z-5 R1 F100 L9999
M30
