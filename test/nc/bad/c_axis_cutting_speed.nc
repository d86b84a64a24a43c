; P-ERR-21745 c_axis_cutting_speed.nc line 4 column 1 'G96 S100': G96 while spindle S is axis C of the path; #CAX OFF first
; machine X Z C / c_axis
#CAX
G96 S100
M30
