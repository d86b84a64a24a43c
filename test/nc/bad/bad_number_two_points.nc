; P-ERR-21003 bad_number_two_points.nc line 2 column 9 'N10 G00 X1.2.3': 'X1.2.3' is not a letter with a number
N10 G00 X1.2.3
M30
