; P-ERR-21063 homing_not_alone_bracket.nc line 3 column 12 'N10 S2[G74 M3]': G74 must be the only function of spindle S2 in its block, not with M3
; machine X / three
N10 S2[G74 M3]
M30
