; H functions beside others, computed, in the order of output.
M08 H5 T3 D1 S100 M03
G00 X1 H65535
P1 = 7
H[P1 * 2]
M30
