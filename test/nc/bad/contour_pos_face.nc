; P-ERR-21115 contour_pos_face.nc line 6 column 1 'G61 G01 X20 C0 F300': mode POS of #CONTOUR MODE with #FACE [X, C]: its interim point is one of the axes
; machine X Z C / c_axis
#CAX
#CONTOUR MODE [POS X20]
#FACE [X, C]
G61 G01 X20 C0 F300
C20
M30
