; P-ERR-21610 system_number_with_decimals.nc line 2 column 9 '#CS ON [1.5] [1,2,3]': coordinate system 1.5 must be an integer from 1 to 5
#CS ON [1.5] [1,2,3]
M30
