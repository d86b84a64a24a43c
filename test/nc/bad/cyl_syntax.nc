; P-ERR-21751 cyl_syntax.nc line 5 column 1 '#CYL [Z, C]': it is written #CYL [Z, C, X60], with the axis along the cylinder, the C axis and the radius, or #CYL OFF
; machine X Z C / c_axis
#CAX
G00 X20 C0
#CYL [Z, C]
M30
