; P-ERR-21076 cax_off_arguments.nc line 4 column 1 '#CAX OFF [S]': #CAX is written [S, C], or #CAX, #CAX OFF
; machine X Z C / c_axis
#CAX
#CAX OFF [S]
M30
