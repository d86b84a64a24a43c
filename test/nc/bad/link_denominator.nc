; P-ERR-21085 link_denominator.nc line 3 column 5 'N10 #SET AX LINK[1, [S2=S, 2]]': ratio 2 of spindle S2 without a denominator
; machine X / three
N10 #SET AX LINK[1, [S2=S, 2]]
M30
