; #CS within each other, stored, with their own offsets, the fixture below them.
G01 X10 Y0 F600
#CS ON [100, 50, 0, 0, 0, 90]
X10 Y0
G92 X5
X10 Y0
#CS ON [2] [0, 0, 10, 90]
X0 Y0 Z0
Z10
#CS OFF
X10 Y0
#CS OFF
X10 Y0
#CS DEF [3] [1, 2, 3]
#CS ON [3]
X0 Y0 Z0
#ACS ON [10, 20, 30]
X0 Y0 Z0
X[V.G.CS_COUNT] Y[V.G.ACS_ACTIVE]
#CS OFF ALL
X0
#ACS OFF
X0 Y0 Z0
G03 X20 I10
#CS ON [0, 0, 0, 0, 0, 90]
G02 X20 I10
M30
