; P-ERR-21548 tap_alone_without_spindle_g63.nc line 3 column 1 'G63': G63 needs a spindle, this channel has none
; machine X Y Z /
G63
M30
