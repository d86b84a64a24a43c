%PROBE
(the centre of a bore in X, then the height of the part, which becomes Z0)
N10 G00 X0 Y0 Z10
N20 G100 X60 F300
N30 P1 = V.A.MEAS.PCS.VALUE.X
N40 G00 X0
N50 G100 X-60 F300
N60 P2 = V.A.MEAS.PCS.VALUE.X
N70 G00 X[[P1 + P2] / 2]
N80 #MSG ["bore %f mm, its centre at X %f", P1 - P2, V.A.ABS.X]
N90 G100 Z-60 F300
N100 G92 Z[V.A.MESS.Z]
N110 G00 Z5
N120 M30
