; tools milling
; after a cycle D is as before, T is the tool that it has changed
%L DRILL
N10 T2 D2
N20 Z0
M29
%MAIN
N100 T1 D1
N110 G00 Z10
N120 L CYCLE [NAME=CHANGES_TOOL.NC]
N130 X[V.G.T_AKT] Y[V.G.D_AKT]
N140 Z10
N150 LL DRILL
N160 Z[V.G.D_AKT]
M30
