; P-ERR-20296 iso_radius_data_unknown.nc line 5 column 5 'G41 D9 G1 X0 Y0': D9: the tool table has no compensation data D9; known are: D1, D2, D3, D7, D13
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D9 G1 X0 Y0
M30
