; P-ERR-20797 reference_offset_of_unknown_axis.nc line 2 column 5 'G92 Q5': axis Q is not in the machine; axes of this channel: X, Y, Z
G92 Q5
M30
