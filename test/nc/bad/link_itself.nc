; P-ERR-20475 link_itself.nc line 3 column 5 'N10 #SET AX LINK[1, S2=S2]': spindle S2 cannot be its own slave
; machine X / three
N10 #SET AX LINK[1, S2=S2]
M30
