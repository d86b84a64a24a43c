; G93: the feed of each block comes from its length in the machine; G94 has its own F.
G01 X10 F600
G93 X30 F2
X30 Y40 Z0
G02 X30 Y60 J10 F4
G03 X30 Y40 Z3 J-10
G01 F1
#SCALE ON X2 Y2
X20
#SCALE OFF
G94 X0
G93 Y0
X[V.G.FEEDRATE_MODE] F10
G70 X1
M30
