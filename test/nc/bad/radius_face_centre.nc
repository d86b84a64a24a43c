; P-ERR-21755 radius_face_centre.nc line 9 column 1 'C10': the path of #FACE [X, C] goes through the centre of rotation, where the C axis has no angle (P-CHAN-00008)
; machine X Z C / c_axis
; tools milling
D2
#CAX
G00 X30 C0
#FACE [X, C]
G41 G01 X3 C-10 F1000
C10
G40 X20
M30
