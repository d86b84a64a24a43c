; P-ERR-21743 cax_on.nc line 4 column 1 '#CAX': #CAX while the spindle is axis C of the path already
; machine X Z C / c_axis
#CAX
#CAX
M30
