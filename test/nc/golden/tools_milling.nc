; tools milling
; the length acts in the normal axis of the plane, offsets in their axes, each with its next absolute word
%TOOLS
N10 T1 D1
N20 G00 X10 Y20
N30 G00 Z5
N40 G18
N50 G00 Z5
N60 G01 Y0 F600
N70 G19 G00 X0
N80 G17 D0
N90 G00 X0 Y0 Z0
N100 T2 D2 G00 X1 Y2 Z3
N110 G91 G01 X1 Z-1
N120 G90 G02 X3 Y2 I0.5 J0
N130 D3
N140 G91 G00 X0 Y0 Z0
N150 G90 G00 X0 Y0 Z0
N160 D13 Z0
N170 T0 D0 Z0
M30
