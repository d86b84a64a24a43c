; P-ERR-21744 cax_not_on.nc line 3 column 1 '#CAX OFF': #CAX OFF while no spindle is an axis of the path
; machine X Z C / c_axis
#CAX OFF
M30
