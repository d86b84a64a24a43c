; P-ERR-90017 radius_arc_too_small.nc line 6 column 1 'G02 X2.5 Y22.5 R2.5': the tool with radius 3 mm is on the inside of an arc with radius 2.5 mm: it does not fit into it
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
Y20
G02 X2.5 Y22.5 R2.5
G01 X30
M30
