; P-ERR-21755 face_arc_through_centre.nc line 6 column 1 'G03 X0 C0 I-10 J0 F1000': the path of #FACE [X, C] goes through the centre of rotation, where the C axis has no angle (P-CHAN-00008)
; machine X Z C / c_axis_milling
#CAX
G00 X20 C0
#FACE [X, C]
G03 X0 C0 I-10 J0 F1000
M30
