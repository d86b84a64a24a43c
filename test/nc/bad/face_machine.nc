; P-ERR-21758 face_machine.nc line 6 column 1 '#MCS ON': #MCS while #FACE [X, C] is on; it needs the positions of the axes
; machine X Z C / c_axis
#CAX
G00 X20 C0
#FACE [X, C]
#MCS ON
M30
