; P-ERR-21548 no_spindle.nc line 3 column 5 'N10 M03 S1000': M03 needs a spindle, this channel has none
; machine X Y Z /
N10 M03 S1000
M30
