; tools milling
; #MCS: positions of the axes, whatever the tool; D, the plane and V.G.WZ_AKT count behind #MCS OFF
V.G.NP[1].V.X = 100
G54 D2 G00 X0 Y0 Z0
#MCS ON
X10 Y20 Z300
T1 D1
Z200
#MCS OFF
X0 Y0 Z0
#MCS ON
G18
X1
V.G.WZ_AKT.L = 50
Y2
#MCS OFF
X0 Y0 Z0
G17
#CS ON [0, 0, 0, 0, 0, 90]
D2
X10 Y0 Z0
#MCS ON
D3
Z250
#MCS OFF
X10 Y0 Z0
#MCS ON
X[V.G.D_AKT]
#MCS OFF
D0 X0 Y0 Z0
M30
