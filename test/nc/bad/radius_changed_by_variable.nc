; P-ERR-21680 radius_changed_by_variable.nc line 6 column 1 'V.G.WZ_AKT.R = 4': V.G.WZ_AKT.R changes the tool from radius 3 mm to radius 4 mm while its radius is compensated; G40 and a straight line end that before it
; tools milling
D2 F600 G00 X-10 Y-10
G41 G01 X0 Y0
X20
V.G.WZ_AKT.R = 4
X30
M30
