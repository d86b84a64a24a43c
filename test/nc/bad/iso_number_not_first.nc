; P-ERR-21009 iso_number_not_first.nc line 3 column 4 'G0 N10 X1': block number N10 must be the first word of the block
; dialect iso
G0 N10 X1
M30
