; P-ERR-21684 radius_departure_arc.nc line 6 column 1 'G40 G02 X40 R20': the motion from the contour, the first one behind G40, is an arc: it must be straight
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
X20
G40 G02 X40 R20
M30
