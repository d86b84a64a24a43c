; P-ERR-20131 iso_unknown_g.nc line 3 column 1 'G77 X0 Y0 R45': unknown G function G77
; dialect iso
G77 X0 Y0 R45
M30
