; P-ERR-21745 cax_m3.nc line 4 column 5 'X10 M3 S100': M03 while spindle S is axis C of the path; #CAX OFF first
; machine X Z C / c_axis
#CAX
X10 M3 S100
M30
