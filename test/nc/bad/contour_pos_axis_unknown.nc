; P-ERR-20797 contour_pos_axis_unknown.nc line 3 column 24 '#CONTOUR MODE [POS X5 Y5]': axis Y is not in the machine; axes of this channel: X, Z
; machine X Z / S
#CONTOUR MODE [POS X5 Y5]
M30
