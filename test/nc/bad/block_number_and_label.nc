; P-ERR-20841 block_number_and_label.nc line 2 column 5 'N10 N20: X1': second block number N20: in one block
N10 N20: X1
M30
