; P-ERR-21612 system_three_brackets.nc line 2 column 22 '#CS ON [1] [1,2] [3,4]': #CS takes up to six values: shift of X, Y, Z in mm, rotation about X, Y, Z in deg
#CS ON [1] [1,2] [3,4]
M30
