; P-ERR-21003 letter_without_number.nc line 2 column 9 'N10 G00 X Y5': 'X' is not a letter with a number
N10 G00 X Y5
M30
