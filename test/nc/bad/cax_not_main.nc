; P-ERR-21175 cax_not_main.nc line 3 column 1 '#CAX [S2, C]': spindle S2 is not the main spindle: #CAX makes S alone an axis of the path
; machine X Z C / c_axis
#CAX [S2, C]
M30
