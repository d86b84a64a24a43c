; P-ERR-21680 iso_radius_changed.nc line 7 column 5 'G41 D1 X30': D1 changes the tool from radius 3 mm to radius 4.99 mm while its radius is compensated; G40 and a straight line end that before it
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D2 G1 X0 Y0
X20
G41 D1 X30
M30
