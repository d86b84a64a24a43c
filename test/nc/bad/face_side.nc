; P-ERR-21756 face_side.nc line 5 column 1 '#FACE [X, C]': #FACE with X at -20 mm, beyond the centre of rotation: a lathe needs 0 or more (P-CHAN-00008)
; machine X Z C / c_axis
#CAX
G00 X-20 C0
#FACE [X, C]
M30
