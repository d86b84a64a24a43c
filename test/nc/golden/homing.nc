; machine X Y Z / three
(reference run of all axes, then to a safe place)
N10 G74 Z1
N15 G01 G90 Z200 F500
N20 G74 X2 Y1 S1
N30 G74 Y3 X3 Z1
N40 G70 G74 X1 Y1
N50 G71 G00 X10 Y20
N60 X30
M30
