; P-ERR-21435 axis_of_variable_index.nc line 2 column 3 'X[V.A.ABS[3]]': the channel has no axis 3; it has: X, Y, Z
X[V.A.ABS[3]]
M30
