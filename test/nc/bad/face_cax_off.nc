; P-ERR-21758 face_cax_off.nc line 6 column 1 '#CAX OFF': #CAX OFF while #FACE [X, C] is on; it needs the positions of the axes
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
#CAX OFF
M30
