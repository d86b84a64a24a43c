; P-ERR-21682 radius_face_element.nc line 8 column 1 'G41 G01 X20 C-10 F1000': no motion in the plane #FACE [X, C] follows the motion to the contour, so where it ends is not known
; machine X Z C / c_axis
; tools milling
D2
#CAX
G00 X30 C0
#FACE [X, C]
G41 G01 X20 C-10 F1000
G40 Z10
M30
