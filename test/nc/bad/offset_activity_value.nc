; P-ERR-21617 offset_activity_value.nc line 2 column 8 'G160=2 X2': G160 with X2: 0 lets the zero offset count for axis X, 1 does not
G160=2 X2
M30
