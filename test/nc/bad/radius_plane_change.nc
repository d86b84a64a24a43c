; P-ERR-20133 radius_plane_change.nc line 6 column 1 'G18': G18 while the tool radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
G18
M30
