; P-ERR-20797 offset_activity_axis.nc line 2 column 8 'G160=2 U1': axis U is not in the machine; axes of this channel: X, Y, Z
G160=2 U1
M30
