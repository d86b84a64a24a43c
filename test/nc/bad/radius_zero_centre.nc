; P-ERR-20036 radius_zero_centre.nc line 2 column 13 'N10 G02 X10 I0 J0 F600': the radius of the circle is 0
N10 G02 X10 I0 J0 F600
M30
