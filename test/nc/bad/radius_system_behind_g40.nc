; P-ERR-20802 radius_system_behind_g40.nc line 7 column 1 '#ACS ON [1, 2, 3, 0, 0, 0]': #ACS ON while the tool radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
G40
#ACS ON [1, 2, 3, 0, 0, 0]
M30
