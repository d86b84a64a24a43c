; P-ERR-21050 iso_back_boring.nc line 3 column 1 'G87 X1': G87 is not available yet: boring with an oriented spindle
; dialect iso
G87 X1
M30
