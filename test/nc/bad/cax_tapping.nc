; P-ERR-21745 cax_tapping.nc line 4 column 1 'G63 Z-5 F100 S100': G63 while spindle S is axis C of the path; #CAX OFF first
; machine X Z C / c_axis
#CAX
G63 Z-5 F100 S100
M30
