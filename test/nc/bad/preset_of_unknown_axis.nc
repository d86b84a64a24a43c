; P-ERR-20797 preset_of_unknown_axis.nc line 2 column 7 '#PSET Q5': axis Q is not in the machine; axes of this channel: X, Y, Z
#PSET Q5
M30
