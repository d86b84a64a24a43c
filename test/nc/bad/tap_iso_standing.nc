; P-ERR-21644 tap_iso_standing.nc line 3 column 1 'G84 X1 Z-5 R1 F100': G84 with speed 0 of spindle S: it needs S = F / pitch
; dialect iso
G84 X1 Z-5 R1 F100
M30
