; P-ERR-21809 iso_g53_incremental.nc line 3 column 5 'G91 G53 G0 X0': G53 with G91: positions in machine coordinates are absolute; G90 first
; dialect iso
G91 G53 G0 X0
M30
