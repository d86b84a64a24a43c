; P-ERR-21084 link_bracket_zero.nc line 3 column 5 'N10 #SET AX LINK[1, [S2=S, 0, 1]]': ratio 0 / 1 of spindle S2: both must be numbers other than 0, their ratio within ±1e-06 ... ±1e+06
; machine X / three
N10 #SET AX LINK[1, [S2=S, 0, 1]]
M30
