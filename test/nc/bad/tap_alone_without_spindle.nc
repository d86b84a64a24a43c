; P-ERR-21548 tap_alone_without_spindle.nc line 3 column 1 'G331': G331 needs a spindle, this channel has none
; machine X Y Z /
G331
M30
