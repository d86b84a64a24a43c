; P-ERR-21681 radius_side_arc.nc line 6 column 1 'G41 G02 X40 R20': G41: the tool changes the side of the contour with an arc; that motion must be a straight line
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
X20
G41 G02 X40 R20
M30
