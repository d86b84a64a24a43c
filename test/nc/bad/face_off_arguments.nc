; P-ERR-21751 face_off_arguments.nc line 6 column 1 '#FACE OFF [X]': it is written #FACE [X, C], with the facing axis and the C axis, or #FACE OFF
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
#FACE OFF [X]
M30
