; P-ERR-21008 feed_twice.nc line 2 column 18 'N10 G01 X10 F600 F700': word F twice in one block: 600 and 700
N10 G01 X10 F600 F700
M30
