; P-ERR-50499 turn_feed_without_speed.nc line 3 column 1 'G01 X10': feed per turn (G95) with speed 0 of spindle S
G95 F0.2
G01 X10
M30
