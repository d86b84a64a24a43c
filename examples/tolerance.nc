(Short lines with corners: the smaller the tolerance of the machine file, the longer it takes, docs/sweeps.md)
N10 #HSC ON [BSPLINE]
N20 G1 X2 Y0.6 F6000
N30 X4 Y0
N40 X6 Y0.9
N50 X8 Y0.2
N60 X10 Y1.2
N70 X12 Y0
N80 X14 Y0.8
N90 X16 Y0
N100 #HSC OFF
N110 M30
