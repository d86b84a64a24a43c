; P-ERR-21017 iso_end_missing.nc line 4 column 1 'G0 X1': main program O1 has no M30 or M02 at its end
; dialect iso
O1
G0 X1
