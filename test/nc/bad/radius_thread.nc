; P-ERR-20651 radius_thread.nc line 6 column 1 'G33 Z50 K1.5': a thread (G33, G34, G35) is not possible while the tool radius is compensated; G40 and a straight line end that before it
; machine X Z C / S
; tools turning
G18 D5 M03 S400
G42 G01 X30 Z105 F100
G33 Z50 K1.5
G40 G01 X60
M30
