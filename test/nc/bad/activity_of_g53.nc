; P-ERR-21622 activity_of_g53.nc line 2 column 1 'G160=0 X1': G160=0: G53 selects no zero offset, so that index 0 has no values (P-ZERO-00001)
G160=0 X1
M30
