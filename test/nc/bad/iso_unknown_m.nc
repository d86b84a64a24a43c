; P-ERR-20160 iso_unknown_m.nc line 3 column 1 'M1000': unknown M function M1000
; dialect iso
M1000
M30
