; P-ERR-21690 radius_face_tip.nc line 8 column 1 'G41 G01 X20 C-10 F1000': G41 while #FACE [X, C] is on with a turning tool, whose tip has a position in the machine
; machine X Z C / c_axis
; tools turning
D5
#CAX
G00 X30 C0
#FACE [X, C]
G41 G01 X20 C-10 F1000
C10
M30
