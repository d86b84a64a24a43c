; P-ERR-21039 comp_empty.nc line 2 column 5 'N10 X[ ]': the brackets of X are empty
N10 X[ ]
M30
