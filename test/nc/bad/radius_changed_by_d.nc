; P-ERR-21680 radius_changed_by_d.nc line 6 column 9 'N50 X30 D1': D1 changes the tool from radius 3 mm to radius 4.99 mm while its radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
N50 X30 D1
M30
