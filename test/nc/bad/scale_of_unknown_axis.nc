; P-ERR-20797 scale_of_unknown_axis.nc line 2 column 8 '#SCALE Q2': axis Q is not in the machine; axes of this channel: X, Y, Z
#SCALE Q2
M30
