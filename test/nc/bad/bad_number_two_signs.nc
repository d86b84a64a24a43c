; P-ERR-21003 bad_number_two_signs.nc line 2 column 9 'N10 G00 X--5': 'X--5' is not a letter with a number
N10 G00 X--5
M30
