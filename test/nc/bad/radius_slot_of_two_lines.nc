; P-ERR-21686 radius_slot_of_two_lines.nc line 6 column 1 'X41 Y30': the tool with radius 3 mm does not fit into the inner corner with line 7 'X38 Y4': the paths beside the motions around it, at most 5 (P-CHAN-90035), do not cross
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X40 Y1
X41 Y30
X38 Y4
X20 Y40
X0
G40 X-20
M30
