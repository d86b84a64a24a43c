; diameters, feed per turn, constant cutting speed
; facing X
G18 G51 G90
N10 G00 X80 Z2
N20 M03 S400
N30 G95 F0.2
N40 G01 Z-10
N50 G02 X90 Z-15 I5 K0 (the centre is programmed in radii)
N60 G196 S2500
N70 G96 S100 (m/min: at this diameter 353.68 rpm)
N80 G01 X20 F0.1
N90 G91 X2 (P-AXIS-00059 is 0: not a diameter)
N100 G90 X1 (the limit counts: 2500 rpm)
N110 G00 X80 (rapid traverse: the speed stays)
N120 G196=1500 G96 S120
N130 G01 X40
N140 M05
N150 M04
N160 G97
N170 G01 X20 Z-20
N180 S600
N190 G94 F240 X10
N200 G52 X10
N210 G95 X12 (F0.1 again)
N220 M30
