; P-ERR-20651 iso_radius_measuring.nc line 7 column 1 'G31 X30': a measuring run is not possible while the tool radius is compensated; G40 and a straight line end that before it
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D2 G1 X0 Y0
X20
G31 X30
M30
