; P-ERR-22010 speed_above_maximum.nc line 3 column 5 'N10 S4001': spindle S: 4001 rpm is above the maximum 4000 rpm (P-AXIS-00212)
; machine X / limited
N10 S4001
N20 G01 X1 F100 M3
N90 M30
