; P-ERR-20131 iso_unknown_g.nc line 3 column 1 'G68 X0 Y0 R45': unknown G function G68
; dialect iso
G68 X0 Y0 R45
M30
