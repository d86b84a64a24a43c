; P-ERR-21817 iso_drill_axis.nc line 4 column 1 'G81 X5 Y-5 R1 F100': G81 drills along Z, which this channel does not have; its axes: X, Y
; machine X Y / S
; dialect iso
G81 X5 Y-5 R1 F100
M30
