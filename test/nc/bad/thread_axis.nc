; P-ERR-21664 thread_axis.nc line 4 column 9 'G33 Z48 C10 K1.5': axis C cannot take part in a thread; G33 moves X, Y and Z
; machine X Z C / S
M03 S400
G33 Z48 C10 K1.5
M30
