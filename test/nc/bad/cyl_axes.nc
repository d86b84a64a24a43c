; P-ERR-21752 cyl_axes.nc line 5 column 1 '#CYL [C, Z, X60]': #CYL with axes C and Z; it is written #CYL [Z, C, X60], with the axis along the cylinder, the C axis and the radius, or #CYL OFF
; machine X Z C / c_axis
#CAX
G00 X20 C0
#CYL [C, Z, X60]
M30
