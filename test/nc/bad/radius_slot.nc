; P-ERR-21686 radius_slot.nc line 6 column 1 'X4': the tool with radius 3 mm does not fit into the inner corner with line 7 'Y0': the paths beside the motions around it, at most 5 (P-CHAN-90035), do not cross
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
Y40
X4
Y0
G40 X-20 Y-20
M30
