; P-ERR-21004 axis_value_too_long.nc line 2 column 7 'G00 X=1234567890123456': number '1234567890123456' has more than 15 digits before the decimal point
G00 X=1234567890123456
M30
