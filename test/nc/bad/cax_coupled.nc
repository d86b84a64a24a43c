; P-ERR-21747 cax_coupled.nc line 5 column 1 '#CAX': #CAX while spindle S is coupled (group 1); #AX LINK OFF first
; machine X Z C / c_axis
#SET AX LINK [1, S2=S]
#ENABLE AX LINK [1]
#CAX
M30
