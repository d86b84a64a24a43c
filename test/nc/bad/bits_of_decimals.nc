; P-ERR-21423 bits_of_decimals.nc line 2 column 4 'P1=5.5 & 1': & needs an integer, not 5.5
P1=5.5 & 1
M30
