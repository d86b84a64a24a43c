(One thread of several blocks without a stop: a taper, a cylinder, a coarser pitch, and out of the groove)
N10 G18 G90 T5 D5
N20 G00 X20 Z52 M03 S600
N30 G33 X22 Z40 K2
N40 Z20
N50 Z0 K3
N60 X26 Z-6
N70 G00 X30
N80 Z52 M05
N90 M30
