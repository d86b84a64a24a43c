; P-ERR-21680 tool_data_radius.nc line 7 column 1 '#TOOL DATA [1]': D1 changes the tool from radius 3 mm to radius 4.99 mm while its radius is compensated; G40 and a straight line end that before it
; machine X Y Z / S
; tools milling
D2
G41 G01 X10 Y0 F600
X20
#TOOL DATA [1]
X30
M30
