; P-ERR-21754 face_not_on.nc line 5 column 1 '#FACE OFF': #FACE OFF without #FACE
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE OFF
M30
