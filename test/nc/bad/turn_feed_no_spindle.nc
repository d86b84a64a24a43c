; P-ERR-21548 turn_feed_no_spindle.nc line 4 column 1 'G01 X1': G95 needs a spindle, this channel has none
; machine X Y Z /
G95 F1
G01 X1
M30
