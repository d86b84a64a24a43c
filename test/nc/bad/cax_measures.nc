; P-ERR-21749 cax_measures.nc line 4 column 6 'G100 C10 F100': a measuring run with axis C: a spindle has no probe
; machine X Z C / c_axis
#CAX
G100 C10 F100
M30
