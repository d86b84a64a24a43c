; P-ERR-21002 iso_exponent.nc line 3 column 6 'G0 X1E5': unknown word 'E5'
; dialect iso
G0 X1E5
M30
