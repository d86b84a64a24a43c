; P-ERR-21548 turn_no_spindle.nc line 4 column 5 'G18 G96 S100': G96 needs a spindle, this channel has none
; machine X Y Z /
; facing X
G18 G96 S100
M30
