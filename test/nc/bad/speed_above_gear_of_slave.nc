; P-ERR-22010 speed_above_gear_of_slave.nc line 6 column 11 'N40 X1 M4 S1001': spindle S2: 2002 rpm is above the maximum 2000 rpm of gear 2 (P-AXIS-00212)
; machine X / limited
N10 #SET AX LINK[1, S2=S, 2, 1]
N20 #ENABLE AX LINK[1]
N30 M3 S1000
N40 X1 M4 S1001
N90 M30
