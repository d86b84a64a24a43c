; P-ERR-20651 iso_radius_g28.nc line 7 column 1 'G28 X0': G28 is not possible while the tool radius is compensated; G40 and a straight line end that before it
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D2 G1 X0 Y0
X20
G28 X0
M30
