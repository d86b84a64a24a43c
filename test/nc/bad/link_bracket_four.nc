; P-ERR-21076 link_bracket_four.nc line 3 column 5 'N10 #SET AX LINK[1, [S2=S, 2, 1, 30]]': #SET AX LINK is written #SET AX LINK [group, slave=master, ...] or [group, [slave=master, num, den], ...]
; machine X / three
N10 #SET AX LINK[1, [S2=S, 2, 1, 30]]
M30
