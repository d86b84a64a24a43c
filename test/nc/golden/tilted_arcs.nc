; Pockets in a face that is tilted about X: full circle, helix, arcs in all planes, linked and mirrored.
#CS ON [50, 20, 5, 30]
G00 X10 Y0 Z0
G03 I-10 F900
G02 X-10 Z-3 I-10
G18 G03 X-20 Z-3 R5
#CONTOUR MODE [DEV PATH_DEV=0.01]
G261
G17 G01 X0
G02 X10 Y10 I10
G01 Y20
G260
G21 G00 X0 Y0
G03 X10 I5
G20
#SCALE X2 Y2
#SCALE ON
G00 X0 Y0
G02 X20 I10
#CS OFF
G00 Z50
M30
