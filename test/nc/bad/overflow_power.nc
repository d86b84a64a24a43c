; P-ERR-21421 overflow_power.nc line 2 column 6 'P1=10**400': the result of ** is beyond the range of numbers
P1=10**400
M30
