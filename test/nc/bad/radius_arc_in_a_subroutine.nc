; P-ERR-90017 radius_arc_in_a_subroutine.nc line 4 column 1 'G02 X2 Y22 R2': the tool with radius 3 mm is on the inside of an arc with radius 2 mm: it does not fit into it
; tools milling
%L PART
G02 X2 Y22 R2
M29
%MAIN
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
Y20
LL PART
G40 G01 X0
M30
