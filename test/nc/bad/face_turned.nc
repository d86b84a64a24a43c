; P-ERR-21757 face_turned.nc line 6 column 1 '#FACE [X, C]': #FACE in coordinates that are rotated, mirrored or scaled
; machine X Z C / c_axis
#CAX
G00 X20 C0
#SCALE ON X2
#FACE [X, C]
M30
