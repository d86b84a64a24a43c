; P-ERR-21065 homing_order_fraction.nc line 3 column 12 'N10 G74 X1 Y1.5': the order of axis Y in G74 must be an integer from 1 to 32, it is 1.5
; machine X Y / three
N10 G74 X1 Y1.5
M30
