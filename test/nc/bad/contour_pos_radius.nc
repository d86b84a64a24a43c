; P-ERR-21115 contour_pos_radius.nc line 6 column 1 'G41 G01 X0 Y10': mode POS of #CONTOUR MODE with compensation of the tool radius: its interim point is one of the axes
; machine X Y Z / S
; tools milling
D2 G00 X0 Y0 F500
#CONTOUR MODE ON [POS X31 Y-1]
G41 G01 X0 Y10
X30
Y40
M30
