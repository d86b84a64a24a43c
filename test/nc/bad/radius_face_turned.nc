; P-ERR-21687 radius_face_turned.nc line 9 column 1 'G41 G01 X20 C-10 F1000': G41 in a tilted plane with different scales, in which nothing keeps its distance
; machine X Z C / c_axis
; tools milling
D2
#CAX
G00 X30 C0
#FACE [X, C]
#CS ON [0, 0, 0, 0, 10, 0]
G41 G01 X20 C-10 F1000
C10
M30
