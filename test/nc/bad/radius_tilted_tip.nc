; P-ERR-21688 radius_tilted_tip.nc line 6 column 1 'G41 G01 X0 Y0': G41 in a tilted plane with a turning tool, whose tip has a position in the machine
; machine X Y Z / S
; tools turning
D6 F100 G00 X-10
#CS ON [0, 0, 0, 30, 0, 0]
G41 G01 X0 Y0
X10
M30
