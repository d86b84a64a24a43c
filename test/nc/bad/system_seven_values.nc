; P-ERR-21612 system_seven_values.nc line 2 column 22 '#CS ON [1,2,3,4,5,6,7]': #CS takes up to six values: shift of X, Y, Z in mm, rotation about X, Y, Z in deg
#CS ON [1,2,3,4,5,6,7]
M30
