; machine X Z / S
; tools turning
; the front turret tool has two edges, D5 and D15; the boring bar is long in Y in G18, so it is used in G17
%TURNING
N10 G18 T5 D5
N20 G00 X40 Z2
N30 G01 Z-20 F200
N40 G02 X44 Z-24 I4 K0
N50 D15 G01
N60 G01 X50
N70 Z-30
N80 P1 = V.G.WZ_AKT.SRK_ID  P2 = V.G.WZ[5].SRK_ID  P3 = V.G.T_AKT  P4 = V.G.D_AKT
N90 #MSG ["cutter %d and %d, T%d D%d", P1, P2, P3, P4]
N100 D0
N110 G17 T6 D6
N120 G00 X0 Z5
M30
