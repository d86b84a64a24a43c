; P-ERR-21435 axis_of_variable_unknown.nc line 2 column 3 'X[V.A.ABS.Q]': the channel has no axis Q; it has: X, Y, Z
X[V.A.ABS.Q]
M30
