; G160: axes for which a zero offset does not count, from its next selection on
V.G.NP[2].V.X = 10 V.G.NP[2].V.Y = 20 V.G.NP[2].V.Z = 30
G160=2 X1 Z1
G55 G00 X0 Y0 Z0
G160=2 X0
X1 Y1 Z1
G55 X1 Y1 Z1
V.G.NP_DEFAULT = 2
P1 = V.G.NP_DEFAULT
G53 X[P1] Y0 Z0
M30
