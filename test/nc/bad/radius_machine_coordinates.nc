; P-ERR-20802 radius_machine_coordinates.nc line 6 column 1 '#MCS ON': #MCS ON while the tool radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
#MCS ON
X30
M30
