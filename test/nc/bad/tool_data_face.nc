; P-ERR-21758 tool_data_face.nc line 7 column 1 '#TOOL DATA [5]': D while #FACE [X, C] is on; it needs the positions of the axes
; machine X Z C / c_axis
; tools turning
#CAX
G00 X30 C0
#FACE [X, C]
#TOOL DATA [5]
M30
