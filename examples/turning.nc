%TURNING (diameters; zero is the face of the finished workpiece, 100 mm in front of the spindle)
N10 V.G.NP[1].V.Z = 100
N20 G54 G18 G90 G51
(--- the stock: diameter 40, 3 mm too long)
N30 T1 D1 M03 S800
N40 G95 F0.25 (mm per turn)
N50 G00 X44 Z3
N60 G196 S3000
N70 G96 S150 (m/min)
(--- face it, then remove the stock down to a cone from 20 to 26 mm)
N80 L CYCLE [NAME=facing.nc @DBEGIN=42 @ZBEGIN=0 @DEND=0 @ZEND=0 @CUT=1]
N90 G00 X40 Z2
N100 L CYCLE [NAME=roughing.nc @DBEGIN=20 @ZBEGIN=0 @DEND=26 @ZEND=-30 @CUT=2 @ALLOWANCE=0.3]
(--- finish: the contour, without a stop at its corners)
N110 S200 F0.1
N120 G00 X18 Z1
N130 G01 Z0
N140 G261 X20 Z-1
N150 X26 Z-30
N160 G260 X41
(--- back: from here on S is in rpm again)
N170 G97
N180 G00 X100 Z100
N190 M05
M30
