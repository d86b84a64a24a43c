; P-ERR-21424 power_of_negative.nc line 2 column 8 'P1=[-8]**0.5': -8 to the power of 0.5 is not a real number
P1=[-8]**0.5
M30
