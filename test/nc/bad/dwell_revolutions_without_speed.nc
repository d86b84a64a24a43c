; P-ERR-21041 dwell_revolutions_without_speed.nc line 2 column 9 'N10 G04 S10': G04 S counts revolutions, but spindle S has no speed
N10 G04 S10
M30
