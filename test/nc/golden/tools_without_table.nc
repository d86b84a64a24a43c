; without a tool table T and D go out as they are
%PLAIN
N10 T4711 D9
N20 G00 X[V.G.T_AKT] Y[V.G.D_AKT] Z[V.G.WZ_AKT.L]
N30 V.G.WZ_AKT.L = 10
N40 Z0
N50 D0 Z0
M30
