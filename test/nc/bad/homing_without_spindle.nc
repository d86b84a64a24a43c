; P-ERR-21064 homing_without_spindle.nc line 3 column 5 'N10 G74': G74 without a spindle; it is written G74 S1 or S[G74]
; machine X / three
N10 G74
M30
