; tools milling
; a contour with outer and inner corners, arcs, a helix and a step that the tool does not reach; functions at their place
N10 T2 D2
N20 G00 X-20 Y-10 Z5
N30 G41 G01 X0 Y0 F600 M8
N40 Z-2
N50 Y40
N60 M9
N70 X20 (outer corner: an arc)
N80 G03 X30 Y50 R10
N90 G01 Y60
N100 X60
N110 Y30
N120 X61 (shorter than the inner corner before it needs)
N130 Y10
N140 G02 X51 Y0 I-10 J0 Z-4
N150 G04 0.5
N160 G01 X0
N170 G40 X-20 Y-10
N180 G00 Z5
; a full circle from the inside, against the clock; G42 changes the side behind it
N190 X0 Y0
N200 G41 G01 X20 Y0
N210 G03 X20 Y0 I-20
N220 G42 G01 X40
N230 Y20
N240 G40 X60
M30
