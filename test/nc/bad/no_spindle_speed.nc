; P-ERR-21548 no_spindle_speed.nc line 3 column 5 'N10 S1000': S needs a spindle, this channel has none
; machine X Y Z /
N10 S1000
M30
