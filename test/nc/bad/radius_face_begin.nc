; P-ERR-20651 radius_face_begin.nc line 8 column 1 '#FACE [X, C]': #FACE [X, C] is not possible while the tool radius is compensated; G40 and a straight line end that before it
; machine X Z C / c_axis
; tools turning
G18 D5
#CAX
G42 G01 X30 Z10 F1000
Z20
#FACE [X, C]
M30
