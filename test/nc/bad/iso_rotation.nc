; P-ERR-21050 iso_rotation.nc line 3 column 1 'G68 X0 Y0 R45': G68 is not available yet: rotation of coordinates
; dialect iso
G68 X0 Y0 R45
M30
