; P-ERR-21012 iso_g28_and_g92.nc line 3 column 5 'G28 G92 X0': G28 and G92 belong to one group (block) and cannot be in one block
; dialect iso
G28 G92 X0
M30
