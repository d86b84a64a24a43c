; P-ERR-21754 face_off_of_cyl.nc line 6 column 1 '#FACE OFF': #FACE OFF without #FACE
; machine X Z C / c_axis
#CAX
G00 X20 C0
#CYL [Z, C, X60]
#FACE OFF
M30
