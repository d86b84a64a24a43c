; P-ERR-21745 c_axis_thread.nc line 4 column 1 'G33 Z-10 K1': G33 while spindle S is axis C of the path; #CAX OFF first
; machine X Z C / c_axis
#CAX
G33 Z-10 K1
M30
