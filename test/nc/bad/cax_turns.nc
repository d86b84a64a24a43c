; P-ERR-21746 cax_turns.nc line 4 column 1 '#CAX': #CAX while spindle S turns: it must be at a standstill (M05 or M19 in a block before)
; machine X Z C / c_axis
M3 S100
#CAX
M30
