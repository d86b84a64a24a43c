; P-ERR-21726 c_axis_feed_per_turn.nc line 7 column 1 'G01 C90': feed per turn (G95) while spindle S is axis C of the path and does not turn; G94 before it
; machine X Z C / c_axis
M3 S500 G95 F0.2
G01 X30 Z20
M5
#CAX
G01 C90
M30
