; P-ERR-21083 position_out_of_range_of_slave.nc line 5 column 14 'N30 M19 S0.1 S.POS=300': position 600000 deg of spindle S2 is not within ±214748.3647 deg
; machine X / three
N10 #SET AX LINK[1, S2=S, 2000, 1]
N20 #ENABLE AX LINK[1]
N30 M19 S0.1 S.POS=300
N90 M30
