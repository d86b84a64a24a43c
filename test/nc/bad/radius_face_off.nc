; P-ERR-20651 radius_face_off.nc line 10 column 1 '#FACE OFF': the end of #FACE or #CYL is not possible while the tool radius is compensated; G40 and a straight line end that before it
; machine X Z C / c_axis
; tools milling
D2
#CAX
G00 X30 C0
#FACE [X, C]
G41 G01 X20 C-10 F1000
C10
#FACE OFF
M30
