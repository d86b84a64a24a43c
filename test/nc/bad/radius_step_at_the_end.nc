; P-ERR-21686 radius_step_at_the_end.nc line 5 column 1 'Y40': the tool with radius 3 mm does not fit into the inner corner with line 6 'X2': the paths beside the motions around it, at most 5 (P-CHAN-90035), do not cross
; tools milling
D2 F600 G00 X-10 Y-10
G42 G01 X0 Y0
Y40
X2
G40 X-20 Y-20
M30
