; P-ERR-20036 radius_zero.nc line 2 column 13 'N10 G02 X10 R0.00001 F600': the radius of the circle is 0
N10 G02 X10 R0.00001 F600
M30
