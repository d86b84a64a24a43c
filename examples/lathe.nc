%LATHE (X is the radius; zero is the face of the workpiece, 100 mm in front of the spindle)
N10 V.G.NP[1].V.Z = 100
N20 G54 G18 G90
(--- turn a shoulder)
N30 T1 D1 M03 S1200
N40 G00 X22 Z2
N50 $FOR P1 = 20, 16, -2
N60 G00 X[P1]
N70 G01 Z-15 F240
N80 G00 X[P1 + 2] Z2
N90 $ENDFOR
N100 G00 X80 Z100
(--- part with both edges of the tool)
N110 T2 D2
N120 G00 X24 Z-25
N130 G01 X10 F60
N140 G00 X24
N150 D12
N160 Z-25 (the other edge is at the same place: the turret moves by the width of the tool)
N170 G01 X10
N180 G00 X80 Z100
(--- drill in the centre)
N190 D0
N200 G17 T3 D3 S2000
N210 #MSG ["T%d, %s %d mm", V.G.T_AKT, "diameter", 2 * V.G.WZ_AKT.R]
N220 G00 X0 Z5
N230 G01 Z-12 F120
N240 G00 Z120
N250 M05
M30
