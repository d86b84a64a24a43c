; P-ERR-20797 long_axis_not_in_machine.nc line 2 column 13 'N10 G00 X10 Y_ACHSE=5': axis Y_ACHSE is not in the machine; axes of this channel: X, Y, Z
N10 G00 X10 Y_ACHSE=5
M30
