; P-ERR-21039 bracket_empty.nc line 2 column 5 'N10 S[ ]': the brackets of S are empty
N10 S[ ]
M30
