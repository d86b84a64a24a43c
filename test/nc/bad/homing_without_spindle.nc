; P-ERR-21064 homing_without_spindle.nc line 3 column 5 'N10 G74': G74 without an axis or spindle; it is written G74 X1, G74 S1 or S[G74]
; machine X / three
N10 G74
M30
