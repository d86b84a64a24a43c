; P-ERR-21758 face_homing.nc line 6 column 1 'G74 X1': G74 while #FACE [X, C] is on; it needs the positions of the axes
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
G74 X1
M30
