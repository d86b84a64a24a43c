; P-ERR-21727 turn_feed_stopped.nc line 5 column 5 'X20 F0.1': feed per turn (G95) of spindle S, which the program has stopped; M03, M04 or G94 before it
M3 S300 G95 F0.2
G01 X10
M5
X20 F0.1
M30
