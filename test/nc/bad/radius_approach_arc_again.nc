; P-ERR-90008 radius_approach_arc_again.nc line 7 column 1 'G42 G02 X40 R20': G42 begins with an arc: the motion to the contour must be a straight line (G00, G01)
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
X20
G40 M8
G42 G02 X40 R20
M30
