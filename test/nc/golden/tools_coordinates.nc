; tools milling
; zero offset and coordinate systems below the tool: D2 turns with #CS, D3 (fixed) does not, #ROTATION turns neither
%PLACES
N10 V.G.NP[1].V.X = 100
N20 V.G.NP[1].V.Z = -50
N30 G54 T2 D2
N40 G00 X0 Y0 Z0
N50 #CS ON [0, 0, 0, 0, 0, 90]
N60 G00 X10 Y0 Z0
N70 #CS OFF
N80 #CS ON [0, 0, 0, 0, 90, 0]
N90 G00 X10 Y0 Z0
N100 D3
N110 G00 X10 Y0 Z0
N120 #CS OFF
N130 #ROTATION ON [ANGLE=90]
N140 G00 X10 Y0 Z0
N150 #ROTATION OFF
N160 G21 G00 X10 Y0 Z0
M30
