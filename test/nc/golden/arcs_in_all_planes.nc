; Arcs with expressions for centre and radius in the three planes, with mirror and offsets.
G92 X5 Y5 Z5
G00 X0 Y0 Z0
P1 = 10
G17 G02 X[P1 * 2] Y0 I[P1] F600
G03 X0 Y0 R[-P1]
G18 G02 X[P1] Z[P1] R[P1]
G03 X0 Z0 I[-P1]
G19 G02 Y[P1] Z[P1] J[P1]
G161 G03 Y0 Z0 J[P1] K0
G162
G17 G21 G02 X[P1] Y[P1] I[P1]
G20 G02 X0 Y0 I0 J[-P1]
M30
