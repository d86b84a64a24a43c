; P-ERR-21086 link_gantry_plain.nc line 3 column 5 'N10 #AX LINK[1, [Y2=Y, G]]': gantry coupling (G) of Y2: path axes cannot be coupled by programs, spindles can
; machine X / three
N10 #AX LINK[1, [Y2=Y, G]]
M30
