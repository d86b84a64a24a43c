; P-ERR-21012 iso_cycle_and_path.nc line 3 column 4 'G0 G81 X1 Z-5 R1': G00 and G81 belong to one group (path) and cannot be in one block
; dialect iso
G0 G81 X1 Z-5 R1
M30
