; P-ERR-21758 face_tool.nc line 6 column 9 'G01 X10 D1 F100': D while #FACE [X, C] is on; it needs the positions of the axes
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
G01 X10 D1 F100
M30
