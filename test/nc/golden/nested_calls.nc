; Four levels of calls with local and cycle variables.
%L D
V.L.A = 4
V.CYC.SUM = V.CYC.SUM + V.L.A
G00 Z=V.CYC.SUM
M29
%L C
V.L.A = 3
V.CYC.SUM = V.CYC.SUM + V.L.A
LL D
X=V.L.A
M29
%L B
V.CYC.SUM = V.CYC.SUM + 2
LL C
LL C
M29
%A
V.CYC.SUM = 1
LL B
Y=V.CYC.SUM
X[V.G.PROG_LEVEL]
M30
