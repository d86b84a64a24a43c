; P-ERR-20797 limits_of_unknown_axis.nc line 2 column 5 'G99 Q4': axis Q is not in the machine; axes of this channel: X, Y, Z
G99 Q4
M30
