; P-ERR-20651 radius_cax.nc line 7 column 1 '#CAX': #CAX is not possible while the tool radius is compensated; G40 and a straight line end that before it
; machine X Z C / c_axis
; tools turning
G18 D5
G42 G01 X30 Z10 F1000
Z20
#CAX
M30
