; P-ERR-21610 system_number_zero.nc line 2 column 9 '#CS ON [0] [1,2,3]': coordinate system 0 must be an integer from 1 to 5
#CS ON [0] [1,2,3]
M30
