; P-ERR-20797 axis_not_in_machine.nc line 2 column 13 'N10 G00 X10 C90': axis C is not in the machine; axes of this channel: X, Y, Z
N10 G00 X10 C90
M30
