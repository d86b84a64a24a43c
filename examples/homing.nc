%HOMING (reference run of all axes, Z first out of the way)
N10 G74 Z1 X2 Y2
N20 G00 Z-5
N30 X50 Y20
N40 G01 Z-20 F600
N50 G00 Z-5
M30
