; P-ERR-21687 radius_tilted_scale.nc line 6 column 1 'G41 G01 X0 Y0': G41 in a tilted plane with different scales, in which nothing keeps its distance
; tools milling
D2 F600 G00 X-10 Y-10
#CS ON [0, 0, 0, 30, 0, 0]
#SCALE ON X2 Y3
G41 G01 X0 Y0
X10
M30
