; tools milling
; outer corners by straight lines, rapid motions, feed at the contour, exact stop, slopes
N10 D2 G00 X-20 Y-10
N20 G25 G42 G01 X0 Y0 F600
N30 X40
N40 X0 Y10 (a sharp corner is cut off)
N50 Y20
N60 G02 X10 Y30 R10
N70 G00 Y60
N80 X0
N90 G40 X-20
N100 G26 G11 G41 G01 X0 Y0 G60
N110 G02 X20 Y0 I10
N120 G10
N130 G02 X40 Y0 I10 G09
N140 G359 G01 X40 Y-20
N150 X40 Y0 (back along itself)
N160 G40 X60
; the direction changes so little that there is no corner
N170 G41 X0 Y0
N180 X10 Y0.000001
N190 X20 Y0
N200 G40 X30 Y10
M30
