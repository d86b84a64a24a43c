; P-ERR-21752 face_axes.nc line 5 column 1 '#FACE [X, Z]': #FACE with axes X and Z; it is written #FACE [X, C], with the facing axis and the C axis, or #FACE OFF
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, Z]
M30
