; P-ERR-21086 link_gantry.nc line 3 column 5 'N10 #SET AX LINK[1, [S2=S, G, 0.01, 0.25]]': gantry coupling (G) of S2: path axes cannot be coupled by programs, spindles can
; machine X / three
N10 #SET AX LINK[1, [S2=S, G, 0.01, 0.25]]
M30
