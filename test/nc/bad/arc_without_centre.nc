; P-ERR-21033 arc_without_centre.nc line 2 column 5 'N10 G02 X10 F600': G02 without a centre (I, J) and without a radius (R)
N10 G02 X10 F600
M30
