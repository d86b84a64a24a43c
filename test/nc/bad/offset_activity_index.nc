; P-ERR-21600 offset_activity_index.nc line 2 column 1 'G160=97 X1': zero offset 97 does not exist: G160=0 to G160=96
G160=97 X1
M30
