; P-ERR-21683 iso_radius_without_d.nc line 5 column 1 'G42 G1 X0 Y0': G42 without a tool: no compensation data with a radius are active
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G42 G1 X0 Y0
X20
M30
