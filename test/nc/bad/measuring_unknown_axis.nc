; P-ERR-20797 measuring_unknown_axis.nc line 2 column 10 'N10 G100 A9 F300': axis A is not in the machine; axes of this channel: X, Y, Z
N10 G100 A9 F300
M30
