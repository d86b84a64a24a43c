; P-ERR-21009 iso_number_twice.nc line 3 column 5 'N10 N20 X1': block number N20 must be the first word of the block
; dialect iso
N10 N20 X1
M30
