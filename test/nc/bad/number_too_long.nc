; P-ERR-21004 number_too_long.nc line 2 column 9 'N10 G00 X1234567890': number 'X1234567890' has more than 9 digits before the decimal point
N10 G00 X1234567890
M30
