; P-ERR-21076 cax_syntax.nc line 3 column 1 '#CAX [S]': #CAX is written [S, C], or #CAX, #CAX OFF
; machine X Z C / c_axis
#CAX [S]
M30
