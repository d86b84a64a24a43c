; P-ERR-20651 iso_radius_g53.nc line 8 column 1 'G53 G0 X0': G53 is not possible while the tool radius is compensated; G40 and a straight line end that before it
; dialect iso
; tools milling
T2 M6
G0 X-10 Y-10 F600
G41 D2 G1 X0 Y0
X20
G53 G0 X0
M30
