; P-ERR-21748 cax_homing.nc line 4 column 5 'G74 C1': G74 of axis C: it is homed as a spindle, G74 S1 before #CAX
; machine X Z C / c_axis
#CAX
G74 C1
M30
