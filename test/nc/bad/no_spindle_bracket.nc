; P-ERR-20180 no_spindle_bracket.nc line 3 column 5 'N10 S[M5]': spindle S is not in the machine; spindles of this channel: none
; machine X Y Z /
N10 S[M5]
M30
