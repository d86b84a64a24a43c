; P-ERR-20651 radius_time_of_blocks.nc line 6 column 1 'G93 X30 F2': a feed by time (G93) is not possible while the tool radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
G93 X30 F2
M30
