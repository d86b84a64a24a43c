; P-ERR-21065 homing_of_axes.nc line 3 column 9 'N10 G74 X0 Y1 S1': the order of axis X in G74 must be an integer from 1 to 32, it is 0
; machine X Y / three
N10 G74 X0 Y1 S1
M30
