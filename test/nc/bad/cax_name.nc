; P-ERR-21741 cax_name.nc line 3 column 1 '#CAX [S, C1]': #CAX gives the axis the name C1; in the machine file it is C (P-CHAN-00010)
; machine X Z C / c_axis
#CAX [S, C1]
M30
