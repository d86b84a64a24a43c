; P-ERR-21745 cax_link.nc line 5 column 1 '#ENABLE AX LINK [1]': #ENABLE AX LINK while spindle S is axis C of the path; #CAX OFF first
; machine X Z C / c_axis
#SET AX LINK [1, S2=S]
#CAX
#ENABLE AX LINK [1]
M30
