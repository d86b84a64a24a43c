; P-ERR-21727 iso_feed_per_turn_stopped.nc line 8 column 1 'G1 X20.': feed per turn (G95) of spindle S, which the program has stopped; M03, M04 or G94 before it
; machine X Z / S
; dialect iso
; facing X
M3 S300
G18 G95 G1 X10. F0.1
M5
G1 X20.
M30
