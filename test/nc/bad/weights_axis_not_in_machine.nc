; P-ERR-20797 weights_axis_not_in_machine.nc line 2 column 14 'N10 G136 X80 A5': axis A is not in the machine; axes of this channel: X, Y, Z
N10 G136 X80 A5
M30
