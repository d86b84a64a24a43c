; P-ERR-21063 homing_not_alone.nc line 3 column 12 'N10 G74 S1 M3': G74 must be the only function of spindle S in its block, not with M03
; machine X / three
N10 G74 S1 M3
M30
