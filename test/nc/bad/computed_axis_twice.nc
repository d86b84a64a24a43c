; P-ERR-20203 computed_axis_twice.nc line 2 column 4 'X5 X[6]': axis X twice in one block: 5 and 6
X5 X[6]
M30
