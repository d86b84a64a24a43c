; P-ERR-20131 iso_twincat_g.nc line 3 column 1 'G70': unknown G function G70
; dialect iso
G70
M30
