; P-ERR-20203 axis_twice.nc line 2 column 17 'N10 G00 X10 Y20 X-10': axis X twice in one block: 10 and -10
N10 G00 X10 Y20 X-10
M30
