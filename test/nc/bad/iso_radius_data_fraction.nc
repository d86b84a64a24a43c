; P-ERR-21010 iso_radius_data_fraction.nc line 5 column 5 'G41 D1.5 G1 X0 Y0': D1.5 must be an integer from 0 to 999999999
; dialect iso
; tools milling
G0 X-10 Y-10 F600
G41 D1.5 G1 X0 Y0
M30
