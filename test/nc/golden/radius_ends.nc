; tools milling
; motions of no length, a motion from the contour to where it ends, a stop on it, and the end of the program in its block
N10 D2 G00 X0 Y0
N20 G42 G01 X0 Y0 F600
N30 X20
N40 X20 M8
N50 Y20 M00
N60 G40 X20 Y20
N70 G41 X40 Y20
N80 X60
N90 G40 M9
N100 Z10
N110 X60 Y0
N120 G42 X80
N130 X100 M30
