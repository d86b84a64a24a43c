; P-ERR-20651 iso_radius_cycle.nc line 7 column 1 'G81 X30 R2 Z-5': the drilling cycle G81 is not possible while the tool radius is compensated; G40 and a straight line end that before it
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D2 G1 X0 Y0
X20
G81 X30 R2 Z-5
M30
