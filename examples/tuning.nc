(Lines and a circle with reversals of x and y: for sweeps of control parameters, docs/sweeps.md)
N10 G135
N20 G1 X20 Y0 F3000
N30 G3 X20 Y0 I-10 J0 F1500
N40 G1 X0 Y0 F3000
N50 M30
