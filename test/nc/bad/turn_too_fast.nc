; P-ERR-22010 turn_too_fast.nc line 4 column 5 'M03 S5000': spindle S: 5000 rpm is above the maximum 4000 rpm (P-AXIS-00212)
; machine X Y Z / limited
G95 F0.2
M03 S5000
M30
