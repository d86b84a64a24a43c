; P-ERR-21065 homing_of_axes.nc line 3 column 9 'N10 G74 X2 Y1 S1': G74 homes spindles only, axis X has no homing
; machine X Y / three
N10 G74 X2 Y1 S1
M30
