; P-ERR-50499 iso_feed_per_turn_speed.nc line 5 column 17 'G18 G95 G1 X10. F0.1': feed per turn (G95) with speed 0 of spindle S
; machine X Z / S
; dialect iso
; facing X
G18 G95 G1 X10. F0.1
M30
