; P-ERR-21009 block_number_in_the_middle.nc line 2 column 13 'N10 G00 X10 N20': block number N20 must be the first word of the block
N10 G00 X10 N20
M30
