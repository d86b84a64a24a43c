; Inch and mm in one program: lengths, feeds, arcs, offsets, state.
G70 G01 X1 Y2 F10
G02 X2 Y2 I0.5
G92 X1
G01 X1
G71 G01 X[V.A.ABS.X] F100
G70 Y[V.A.ABS.X]
X[V.G.FEEDRATE]
G71 G92 X0
X0
M30
