; P-ERR-21685 radius_too_narrow.nc line 5 column 1 'X40': the path of the tool comes as near as 1 mm to line 8 'Y4', its radius is 3 mm: it does not fit between them
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X40
Y20
X30
Y4
X0
G40 X-20
M30
