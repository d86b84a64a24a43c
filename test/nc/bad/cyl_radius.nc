; P-ERR-21753 cyl_radius.nc line 5 column 1 '#CYL [Z, C, X0]': radius 0 mm of #CYL must be above 0
; machine X Z C / c_axis
#CAX
G00 X20 C0
#CYL [Z, C, X0]
M30
