; P-ERR-21013 homing_unknown_axis.nc line 3 column 12 'N10 G74 X1 C1': C has no meaning with G74
; machine X Y / three
N10 G74 X1 C1
M30
