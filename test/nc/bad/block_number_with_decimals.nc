; P-ERR-21010 block_number_with_decimals.nc line 2 column 1 'N10.5 G00 X10': N10.5 must be an integer from 0 to 999999999
N10.5 G00 X10
M30
