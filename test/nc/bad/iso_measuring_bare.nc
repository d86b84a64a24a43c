; P-ERR-21100 iso_measuring_bare.nc line 4 column 1 'G31': G31 without an axis: its axis words are the end of the measuring run
; dialect iso
G1 X5 F300
G31
M30
