; P-ERR-21077 link_group.nc line 3 column 5 'N10 #SET AX LINK[4, S2=S]': coupling group 4 must be a number from 1 to 3
; machine X / three
N10 #SET AX LINK[4, S2=S]
M30
