; P-ERR-20131 iso_unknown_g_decimal.nc line 3 column 1 'G54.2': unknown G function G54.2
; dialect iso
G54.2
M30
