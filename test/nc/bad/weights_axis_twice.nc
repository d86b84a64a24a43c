; P-ERR-20203 weights_axis_twice.nc line 2 column 14 'N10 G136 X80 X70': axis X twice in one block: 80 and 70
N10 G136 X80 X70
M30
