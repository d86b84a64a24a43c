; P-ERR-20180 no_spindle_bracket.nc line 3 column 5 'N10 S[M5]': spindle S does not belong to this channel; its spindles are: none
; machine X Y Z /
N10 S[M5]
M30
