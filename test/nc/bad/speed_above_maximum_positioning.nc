; P-ERR-22010 speed_above_maximum_positioning.nc line 3 column 9 'N10 M19 S5000 S.POS=0': spindle S: 5000 rpm is above the maximum 4000 rpm (P-AXIS-00212)
; machine X / limited
N10 M19 S5000 S.POS=0
N90 M30
