; P-ERR-21068 coupled_spindle.nc line 4 column 13 'N20 M3 S100 S2[M4 REV50]': spindle S2 follows spindle S (coupling group 0) and takes no functions of its own
; machine X / linked
N10 #ENABLE AX LINK
N20 M3 S100 S2[M4 REV50]
M30
