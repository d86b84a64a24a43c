; P-ERR-90017 radius_full_circle_too_small.nc line 5 column 1 'G03 X0 Y0 I3': the tool with radius 3 mm is on the inside of an arc with radius 3 mm: it does not fit into it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
G03 X0 Y0 I3
G40 G01 X-10
M30
