; P-ERR-20991 computed_speed_negative.nc line 2 column 1 'S[M3 REV[-5]]': speed -5 rpm of spindle S is negative
S[M3 REV[-5]]
M30
