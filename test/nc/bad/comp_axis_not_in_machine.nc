; P-ERR-20797 comp_axis_not_in_machine.nc line 2 column 5 'N10 A[COMP ON FRICT]': axis A is not in the machine; axes of this channel: X, Y, Z
N10 A[COMP ON FRICT]
M30
